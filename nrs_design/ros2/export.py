"""Impedance controllers of a design as parameters of ``admittance_controller``, if that is proved.

That controller computes another law than the robot of the spec: one step of symplectic Euler in
each period, and no motion loop of its own (`nrs_design.ros2.axis`). So it is proved anew, from the
numbers as they are written, and nothing is written without that proof. With stiffness 0 its law is
``v' = f/M - d v``: ``Mt v' + Bt v = F`` with ``M = Mt`` and ``d = Bt/Mt``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

from nrs_design import __version__
from nrs_design.certificates.catalogue import sentences
from nrs_design.certificates.certificate import Certificate
from nrs_design.controllers.controller_design import Controller
from nrs_design.errors import DesignError, SpecError
from nrs_design.exporters.build import OUTSIDE
from nrs_design.pipeline.design import Designed
from nrs_design.proof.system import SwitchedSystem
from nrs_design.proof.text import exact_text
from nrs_design.ros2.axis import ControllerContext, assumptions, close_axis
from nrs_design.ros2.law import AXES, AdmittanceLaw, read_law
from nrs_design.ros2.parameters import parse_nodes
from nrs_design.ros2.quantities import Range
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.spec.sampling import SamplingSpec

BEGINNING = b"# nrs-design ros2 of "
# Gains are single-precision numbers; what is proved is the law as it is written.
ALIKE = Fraction(1, 2**22)
SEVERITY = ("proved", "inconclusive", "refuted")
# What the controller needs besides, which no design knows.
BESIDE = (
    "joints (at least six: fewer couple the axes), command_interfaces, state_interfaces, "
    "chainable_command_interfaces, kinematics, ft_sensor.name, frames, gravity_compensation"
)


@dataclass(frozen=True, slots=True)
class RosExport:
    """One controller as a parameter file, or why there is none."""

    controller: str  # Its name in the spec
    verdict: str  # The worst of its axes, under the law that ROS 2 computes with these parameters
    text: str  # The file; empty without a proof
    # By axis: its modes, and what is shown of them.
    certificates: Mapping[str, Certificate]


def export_controllers(
    designs: Mapping[str, Designed], lag: Range, limits: Limits
) -> Iterator[RosExport]:
    """Yield every controller of a design, or of the axes of an arm, with its proof.

    Designs are by axis of the control frame, ``x`` to ``rz``. The lag is the smallest and largest
    time constant in s with which the robot follows its command.
    """
    samplings = {axis: _sampling(designed) for axis, designed in designs.items()}
    (axis, sampling), *others = samplings.items()
    share = _filter_share(designs[axis], sampling)
    for other, own in others:
        alike = (own.period.exact, own.delay) == (sampling.period.exact, sampling.delay)
        if not alike or _filter_share(designs[other], own) != share:
            raise DesignError(
                f"{axis} and {other} do not have one period, delay and filter",
                remedy="say sampling and sensor in common",
                at=("sampling",),
            )
    for name, controllers in _controllers(designs):
        touched = {axis: _met(designs[axis], one) for axis, one in controllers.items()}
        body = _body(controllers, share, _rate(sampling))
        law = _law_in(body, name)
        verdicts, certificates = list[str](), dict[str, Certificate]()
        for axis, met in touched.items():
            around = ControllerContext(sampling.period.exact, sampling.delay, met, met, lag)
            closed = close_axis(law, law.axes[AXES.index(axis)], around)
            system = _with_contact(designs[axis], closed)
            found = certify(system, limits=limits)
            verdicts.append(str(found.verdict))
            if found.statements:
                certificates[axis] = Certificate(
                    spec_name=designs[axis].spec.name,
                    spec_sha256=designs[axis].loaded.sha256,
                    coordinates=None,
                    gains={},
                    system=system,
                    statements=found.statements,
                    version=__version__,
                )
        worst = max(verdicts, key=SEVERITY.index)
        text = ""
        if worst == "proved" and len(certificates) == len(touched):
            about = [
                line
                for axis, met in touched.items()
                for line in _about(axis, designs[axis], met, certificates[axis])
            ]
            about += [f"taken for granted: {words}" for words in assumptions(around)]
            spec = next(iter(designs.values())).spec.name
            text = _header(name, spec, sampling, about, len(touched)) + body
        yield RosExport(name, worst, text, certificates)


def _controllers(designs: Mapping[str, Designed]) -> Iterator[tuple[str, dict[str, Controller]]]:
    """Yield what is written together: a controller of every axis, the only one if it has one."""
    each = {
        axis: {c.name: c for c in designed.design.controllers} for axis, designed in designs.items()
    }
    several = {axis: known for axis, known in each.items() if len(known) > 1}
    names = next(iter(several.values()), next(iter(each.values())))
    for axis, known in several.items():
        if known.keys() != names.keys():
            raise DesignError(
                f"the controllers of {axis} are {', '.join(known)}, and not {', '.join(names)}: "
                "admittance_controller switches all axes at once",
                remedy="give every axis one controller, or the same names",
                at=("controllers",),
            )
    for name in names:
        own = {axis: known.get(name, next(iter(known.values()))) for axis, known in each.items()}
        rates = {axis: c.law.gains["Bt"] / c.law.gains["Mt"] for axis, c in own.items()}
        (first, rate), *others = rates.items()
        odd = next((axis for axis, other in others if abs(other - rate) > ALIKE * rate), None)
        if odd is not None:
            raise DesignError(
                f"Bt/Mt is {float(rate):.6g} 1/s in {first} and {float(rates[odd]):.6g} 1/s in "
                f"{odd}: admittance_controller has one joint_damping for all axes",
                remedy="choose Mt of each axis so that Bt/Mt is the same",
                at=("controllers", own[odd].name),
            )
        yield name, own


def _sampling(designed: Designed) -> SamplingSpec:
    """Return the processor of a spec whose controllers can be written."""
    if designed.spec.sampling is None:
        raise DesignError(
            "the spec does not say when its law runs and how old its force is",
            remedy="add `sampling: {period: 2 ms, delay: [0, 1]}`",
        )
    if designed.spec.sampling.round > 1:
        raise DesignError(
            "a controller of ros2_control has one period, and the outer loop has its own",
            remedy="leave outer_period out",
            at=("sampling", "outer_period"),
        )
    if (late := designed.spec.late_at) is not None:
        raise DesignError(
            "the loop of a robot that follows its command by a lag takes commands at their sample",
            remedy=f"leave {late[1]} out here, and count it into `delay` or the lag",
            at=late,
        )
    for controller in designed.design.controllers:
        gains = controller.law.gains
        if gains.keys() != {"Mt", "Bt"} or not gains["Mt"]:
            raise DesignError(
                f"admittance_controller cannot run {controller.name}: it is written for impedance "
                "controllers with inertia and without a spring",
                remedy="use type impedance with Mt > 0 and without Kt",
                at=("controllers", controller.name),
            )
    return designed.spec.sampling


def _with_contact(designed: Designed, system: SwitchedSystem) -> SwitchedSystem:
    """Ask for a proof through any loss of contact where the spec does."""
    if designed.spec.contact != "losable":
        return system
    if system.contact is None:
        raise DesignError(
            "with admittance_controller, loss of contact is modelled for one age of the force only",
            remedy="give `delay` as one number, or `contact: kept`",
            at=("sampling", "delay"),
        )
    return replace(system, contact=replace(system.contact, required=True))


def _rate(sampling: SamplingSpec) -> int:
    rate = 1 / sampling.period.exact
    if rate.denominator != 1:
        raise DesignError(
            f"a period of {sampling.period.text} is no whole number of periods in a second",
            remedy="choose one that is, such as 2 ms: update_rate is an integer",
            at=("sampling", "period"),
        )
    return int(rate)


def _filter_share(designed: Designed, sampling: SamplingSpec) -> Fraction:
    """Return the share of the new sample in the smoothed force; 1 without a filter."""
    low_pass = designed.design.sensor.filter
    if low_pass is None:
        return Fraction(1)
    if low_pass.order != 1:
        raise DesignError(
            f"the filter of the force has order {low_pass.order}, and that of "
            "admittance_controller has order 1",
            remedy="give a filter of order 1",
            at=("sensor", "filter"),
        )
    return 1 - low_pass.discretize(sampling.period.exact).p


def _met(designed: Designed, controller: Controller) -> Range:
    """Return the stiffness that a controller may touch, in N m/rad or N/m."""
    touched = designed.plant.among(controller.contacts)
    soft = next((item for item in touched if item.parameters.keys() != {"k"}), None)
    if soft is not None:
        raise DesignError(
            f"{soft.name} is more than a spring, which is not modelled with admittance_controller",
            remedy="give it the model elastic",
            at=("environments", soft.name),
        )
    return min(i.stiffness.low for i in touched), max(i.stiffness.high for i in touched)


def _body(controllers: Mapping[str, Controller], share: Fraction, rate: int) -> str:
    masses = {axis: controller.law.gains["Mt"] for axis, controller in controllers.items()}
    # The mass of an axis that is not selected has no effect.
    first = next(iter(controllers.values())).law.gains
    Mt, Bt = first["Mt"], first["Bt"]
    values: Mapping[str, str] = {
        "selected_axes": _list("true" if name in controllers else "false" for name in AXES),
        "mass": _list(_double(masses.get(name, Mt)) for name in AXES),
        # Without stiffness it has no effect; anything else would look as if it had.
        "damping_ratio": _list("0.0" for _ in AXES),
        "stiffness": _list("0.0" for _ in AXES),
        "joint_damping": _double(Bt / Mt),
    }
    return "".join(
        (
            "controller_manager:\n  ros__parameters:\n",
            f"    update_rate: {rate}\n\n",
            "admittance_controller:\n  ros__parameters:\n",
            f"    ft_sensor:\n      filter_coefficient: {_double(share)}\n",
            "    admittance:\n",
            *(f"      {name}: {value}\n" for name, value in values.items()),
            "    enable_parameter_update_without_reactivation: false\n",
        )
    )


def _law_in(body: str, controller: str) -> AdmittanceLaw:
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


def _header(name: str, spec: str, sampling: SamplingSpec, about: Sequence[str], axes: int) -> str:
    least, most = sampling.delay
    lines = [
        f"nrs-design ros2 of {spec}, controller {name}, nrs-design {__version__}",
        "verdict: PROVED, of the law as admittance_controller computes it with these numbers",
        f"sample time: {exact_text(sampling.period.exact)} s, measurements {least} to {most} "
        "samples old",
        *about,
        *(f"outside the proof: {text}" for text in OUTSIDE),
        "outside the proof: switching to another controller; the same joint_damping acts on all "
        "axes, and no force on those that are not selected",
        *(("outside the proof: what the axes do to each other",) if axes > 1 else ()),
        f"to be given beside this file: {BESIDE}",
    ]
    return "".join(f"# {line}\n" for line in lines)


def _about(axis: str, designed: Designed, met: Range, certificate: Certificate) -> Iterator[str]:
    """Yield what is proved of one axis."""
    evidence, spec = certificate.evidence, designed.spec
    assert evidence is not None, "proved by something"
    unit = spec.axis.unit
    yield f"axis {axis}: spec: {spec.name}, sha256 {designed.loaded.sha256}"
    yield f"axis {axis}: certificate: {certificate.id}"
    yield f"axis {axis}: claim: {evidence.claim(certificate.system)}"
    low, high = map(float, met)
    yield f"axis {axis}: touched: {low!r} to {high!r} {unit('N*m/rad')}"
    yield f"axis {axis}: units: {unit('kg*m^2')}, {unit('N*m/rad')}, joint_damping in 1/s"
    # A claim says that contact is kept only where its loss is modelled.
    kept = ("contact is not lost",) if certificate.system.contact is None else ()
    for text in (*sentences(certificate.granted), *kept):
        yield f"axis {axis}: taken for granted: {text}"


def _list(items: Iterator[str]) -> str:
    return f"[{', '.join(items)}]"


def _double(number: Fraction) -> str:
    """Write the double next to a number with all its digits, so that what is proved is what runs.

    There is always a point and never an exponent, as ROS 2 wants it.
    """
    text = format(Decimal(float(number)), "f")
    return text if "." in text else f"{text}.0"
