"""Impedance controllers of a design as parameters of ``admittance_controller``, if that is proved.

That controller computes another law than the robot of the spec: one step of symplectic Euler in
each period, and no motion loop of its own (`nrs_design.ros2.axis`). So it is proved anew, from the
numbers as they are written, and nothing is written without that proof. With stiffness 0 its law is
``v' = f/M - d v``: ``Mt v' + Bt v = F`` with ``M = Mt`` and ``d = Bt/Mt``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

from nrs_design import __version__
from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.controller_design import Controller
from nrs_design.errors import DesignError, SpecError
from nrs_design.exporters.build import UNMODELED_EFFECTS
from nrs_design.pipeline.design import Designed
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text
from nrs_design.ros2.axis import ControllerContext, assumptions, close_axis
from nrs_design.ros2.law import AXES, AdmittanceLaw, Range, read_law
from nrs_design.ros2.parameters import parse_nodes
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.spec.sampling import SamplingSpec

BEGINNING = b"# nrs-design ros2 of "
SEVERITY = ("proved", "inconclusive", "refuted")
# Further parameters of the controller, which no design knows.
REQUIRED_PARAMETERS = (
    "joints (at least six: fewer couple the axes), command_interfaces, state_interfaces, "
    "chainable_command_interfaces, kinematics, ft_sensor.name, frames, gravity_compensation"
)


@dataclass(frozen=True, slots=True)
class RosExport:
    """Verdict on a controller; with a proof, also the parameter file."""

    controller: str  # Its name in the spec
    verdict: str  # Under the law that ROS 2 computes with these parameters
    text: str  # The file; empty without a proof
    certificate: Certificate | None  # Modes and proof


def export_controllers(
    designed: Designed, axis: str, lag: Range, limits: Limits
) -> Iterator[RosExport]:
    """Yield every controller of a design, with its proof.

    The axis of the control frame is one of ``x`` to ``rz``. The lag is the smallest and largest
    time constant in s with which the robot follows its command.
    """
    sampling = _sampling(designed)
    share = _filter_share(designed, sampling)
    for controller in designed.design.controllers:
        k, name = _stiffness_range(designed, controller), controller.name
        body = _body(axis, controller, share, sampling)
        law = _read_back(body, name)
        context = ControllerContext(sampling.delay, k, k, lag, sampling.period.exact)
        closed = close_axis(law, law.axes[AXES.index(axis)], context)
        system = _require_contact(designed, closed)
        found = certify(system, limits=limits)
        verdict, text, certificate = str(found.verdict), "", None
        if found.statements:
            certificate = Certificate(
                spec_name=designed.spec.name,
                spec_sha256=designed.loaded.sha256,
                coordinates=None,
                gains={},
                system=system,
                statements=found.statements,
                version=__version__,
            )
        if verdict == "proved" and certificate is not None:
            notes = [*_proof_lines(axis, designed, k, certificate)]
            notes += [f"taken for granted: {words}" for words in assumptions(context)]
            text = _header(name, designed.spec.name, sampling, notes) + body
        yield RosExport(name, verdict, text, certificate)


def _refuse(wrong: bool, message: str, remedy: str, *at: str) -> None:
    if wrong:
        raise DesignError(message, remedy=remedy, at=at)


def _sampling(designed: Designed) -> SamplingSpec:
    """Return the processor of a spec whose controllers can be written."""
    sampling, delay_key = designed.spec.sampling, designed.spec.late_at
    if sampling is None:
        raise DesignError(
            "the spec does not say when its law runs and how old its force is",
            remedy="add `sampling: {period: 2 ms, delay: [0, 1]}`",
        )
    _refuse(
        sampling.round > 1,
        "a controller of ros2_control has one period, and the outer loop has its own",
        "leave outer_period out",
        *("sampling", "outer_period"),
    )
    _refuse(
        (1 / sampling.period.exact).denominator != 1,
        f"a period of {sampling.period.text} is no whole number of periods in a second",
        "choose one that is, such as 2 ms: update_rate is an integer",
        *("sampling", "period"),
    )
    if delay_key is not None:
        raise DesignError(
            "the loop of a robot that follows its command by a lag takes commands at their sample",
            remedy=f"leave {delay_key[1]} out here, and count it into `delay` or the lag",
            at=delay_key,
        )
    for controller in designed.design.controllers:
        gains = controller.law.gains
        _refuse(
            gains.keys() != {"Mt", "Bt"} or not gains["Mt"],
            f"admittance_controller cannot run {controller.name}: it is written for impedance "
            "controllers with inertia and without a spring",
            "use type impedance with Mt > 0 and without Kt",
            *("controllers", controller.name),
        )
    return sampling


def _require_contact(designed: Designed, system: SwitchedSystem) -> SwitchedSystem:
    """Require a proof through any loss of contact where the spec does."""
    if designed.spec.contact != "losable":
        return system
    if system.contact is None:
        raise DesignError(
            "with admittance_controller, loss of contact is modelled for one age of the force only",
            remedy="give `delay` as one number, or `contact: kept`",
            at=("sampling", "delay"),
        )
    return replace(system, contact=replace(system.contact, required=True))


def _filter_share(designed: Designed, sampling: SamplingSpec) -> Fraction:
    """Return the share of the new sample in the smoothed force; 1 without a filter."""
    low_pass = designed.design.sensor.filter
    if low_pass is None:
        return Fraction(1)
    _refuse(
        low_pass.order != 1,
        f"the filter of the force has order {low_pass.order}, and that of admittance_controller "
        "has order 1",
        "give a filter of order 1",
        *("sensor", "filter"),
    )
    return 1 - low_pass.discretize(sampling.period.exact).p


def _stiffness_range(designed: Designed, controller: Controller) -> Range:
    """Return the stiffness that a controller may touch, in N m/rad or N/m."""
    contacts = designed.plant.select_environments(controller.contacts)
    for one in contacts:
        _refuse(
            one.parameters.keys() != {"k"},
            f"{one.name} is more than a spring, which is not modelled with admittance_controller",
            "give it the model elastic",
            *("environments", one.name),
        )
    return min(i.stiffness.low for i in contacts), max(i.stiffness.high for i in contacts)


def _body(axis: str, controller: Controller, share: Fraction, sampling: SamplingSpec) -> str:
    Mt, Bt = controller.law.gains["Mt"], controller.law.gains["Bt"]
    values = {
        "selected_axes": ["true" if name == axis else "false" for name in AXES],
        # The mass of an axis that is not selected has no effect.
        "mass": [_double(Mt)] * len(AXES),
        # Without stiffness the ratio has no effect, so the file shows 0.
        "damping_ratio": ["0.0"] * len(AXES),
        "stiffness": ["0.0"] * len(AXES),
    }
    return "".join(
        (
            "controller_manager:\n  ros__parameters:\n",
            f"    update_rate: {1 / sampling.period.exact}\n\n",
            "admittance_controller:\n  ros__parameters:\n",
            f"    ft_sensor:\n      filter_coefficient: {_double(share)}\n",
            "    admittance:\n",
            *(f"      {name}: [{', '.join(items)}]\n" for name, items in values.items()),
            f"      joint_damping: {_double(Bt / Mt)}\n",
            "    enable_parameter_update_without_reactivation: false\n",
        )
    )


def _read_back(body: str, controller: str) -> AdmittanceLaw:
    """Read the parameters back, as ROS 2 does: names, types and bounds."""
    nodes = parse_nodes(body, Path("exported parameters"))
    try:
        return read_law(next(node for node in nodes if node.name == "admittance_controller"))
    except SpecError as error:
        raise DesignError(
            f"admittance_controller would not start with the gains of {controller}: "
            f"{error.message}",
            remedy="choose gains within its bounds, or another controller",
            at=("controllers", controller),
        ) from None


def _header(name: str, spec: str, sampling: SamplingSpec, notes: Sequence[str]) -> str:
    age_low, age_high = sampling.delay
    lines = [
        f"nrs-design ros2 of {spec}, controller {name}, nrs-design {__version__}",
        "verdict: PROVED, of the law as admittance_controller computes it with these numbers",
        f"sample time: {exact_text(sampling.period.exact)} s, measurements {age_low} to {age_high} "
        "samples old",
        *notes,
        *(f"outside the proof: {text}" for text in UNMODELED_EFFECTS),
        "outside the proof: switching to another controller; the same joint_damping acts on all "
        "axes, and no force on those that are not selected",
        f"to be given beside this file: {REQUIRED_PARAMETERS}",
    ]
    return "".join(f"# {line}\n" for line in lines)


def _proof_lines(
    axis: str, designed: Designed, k: Range, certificate: Certificate
) -> Iterator[str]:
    """Yield lines that describe the proof of an axis."""
    evidence, spec = certificate.evidence, designed.spec
    assert evidence is not None, "proved by something"
    unit = spec.axis.unit
    yield f"axis {axis}: spec: {spec.name}, sha256 {designed.loaded.sha256}"
    yield f"axis {axis}: certificate: {certificate.id}"
    yield f"axis {axis}: claim: {evidence.claim(certificate.system)}"
    low, high = map(float, k)
    yield f"axis {axis}: touched: {low!r} to {high!r} {unit('N*m/rad')}"
    yield f"axis {axis}: units: {unit('kg*m^2')}, {unit('N*m/rad')}, joint_damping in 1/s"
    # A claim says that contact is kept only where its loss is modelled.
    contact_notes = ("contact is not lost",) if certificate.system.contact is None else ()
    for text in (*sentences(certificate.granted), *contact_notes):
        yield f"axis {axis}: taken for granted: {text}"


def _double(number: Fraction) -> str:
    """Write the double next to a number with all its digits, so that what is proved is what runs.

    There is always a point and never an exponent, as ROS 2 wants it.
    """
    text = format(Decimal(float(number)), "f")
    return text if "." in text else f"{text}.0"
