"""One sample of a law as a list of operations: PD control below the compliant laws.

The list is the law, for the program and for the proof: `nrs_design.switched.sampled_law` takes the
matrices and the roundings of a certificate from it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.controllers.sampled import SampledAdmittance, SampledForce, SampledLaw
from nrs_design.controllers.step_parts import (
    BEYOND,
    HAND,
    VELOCITY,
    StepFrame,
    StepLimits,
    admitted,
    error_before,
    filtered,
    lags,
    motion,
)

UNITS = {"command": "rpm"}
ONE, ZERO = Fraction(1), Fraction(0)


def build_law(
    frame: StepFrame, laws: Mapping[str, SampledLaw], idle: Fraction | None = None
) -> StepLaw:
    """Write the laws of controllers out, by the names of these.

    Parameters
    ----------
    frame : StepFrame
        Below and before all of them.
    laws : mapping of str to SampledAdmittance or SampledForce
        By the names of their controllers; all admittances have an inertia, or none has.
    idle : Fraction, optional
        What a sample leaves of the states of idle admittances, where there are both kinds, and of
        an integral of the force error beside others.
    """
    moving = {name: law for name, law in laws.items() if isinstance(law, SampledAdmittance)}
    placed = {name: law for name, law in laws.items() if isinstance(law, SampledForce)}
    if not moving:
        return build_placed_law(frame, placed, idle or ZERO)
    if not placed:
        return build_step_law(frame, moving)
    assert idle is not None, "beside others, admittances are idle at times"
    return build_mixed_law(frame, laws, idle)


def numbers_of(frame: StepFrame, law: SampledLaw, idle: Fraction | None) -> dict[str, Fraction]:
    """Return the coefficients of one controller by name, be they single-precision numbers or not.

    Parameters
    ----------
    frame, idle
        As for `build_law`; ``idle`` where there are other controllers, too.
    law : SampledAdmittance or SampledForce
        Of the controller.
    """
    found = {c.name: c.of(0) for c in (*frame.coefficients, _force_gains((law,)))}
    found |= {c.name: c.of(0) for c in _integral_gains((law,), idle or ZERO)}
    if isinstance(law, SampledAdmittance):
        return found | {c.name: c.of(0) for c in _admittances((law,), idle)}
    # Of both states of an idle admittance, the same is left.
    return found if idle is None else found | {"d": idle, "a": idle}


def build_step_law(frame: StepFrame, laws: Mapping[str, SampledAdmittance]) -> StepLaw:
    """Write impedance control out, by the names of its controllers.

    All of them have a virtual inertia, or none has.
    """
    limits = frame.limits
    inert = any(law.a is not None for law in laws.values())
    sprung = any(law.Kt for law in laws.values())
    following = {"reference": "next_reference", **frame.memory}
    following |= {"velocity": "next_velocity"} if inert else {}
    following |= {"commanded": "next_commanded"} if sprung else {}
    return StepLaw(
        tuple(laws),
        (*limits.measured, HAND),
        tuple(_states(limits, frame.order, inert=inert, sprung=sprung)),
        (
            *frame.coefficients,
            *_admittances(laws.values()),
            *_hand(limits),
            *limits.coefficients,
        ),
        (
            *filtered(frame.order),
            *motion(limits),
            *_moving(frame.force, inert=inert, sprung=sprung),
        ),
        limits.output,
        following,
        UNITS,
    )


def build_placed_law(
    frame: StepFrame, laws: Mapping[str, SampledForce], idle: Fraction = ZERO
) -> StepLaw:
    """Write position and force control out; neither has a reference of its own.

    Parameters
    ----------
    frame : StepFrame
        Below and before all of them.
    laws : mapping of str to SampledForce
        By the names of their controllers.
    idle : Fraction
        What a sample leaves of an integral while another controller is active.
    """
    limits = frame.limits
    integral = _Integral.of(laws.values(), idle, limits)
    gains = (_force_gains(laws.values()), *integral.coefficients)
    place = Operation("reference", "add", "position", integral.correction, "angle")
    return StepLaw(
        tuple(laws),
        (*limits.measured, *limits.commanded),
        (error_before(2 * BEYOND), *lags(frame.order), *integral.states),
        (*frame.coefficients, *gains, *limits.coefficients),
        (
            *filtered(frame.order),
            *_correction(frame.force),
            *integral.added,
            place,
            *motion(limits),
            *integral.advanced,
        ),
        limits.output,
        {**frame.memory, **integral.memory},
        UNITS,
    )


def build_mixed_law(frame: StepFrame, laws: Mapping[str, SampledLaw], idle: Fraction) -> StepLaw:
    """Write impedance control beside position and force control out.

    The reference of impedance control is counted from the commanded position. While another
    controller is active, it and the velocity of the admittances decay. A product with zero or one
    is exact, and so is a sum with zero: what is absent in a mode rounds nothing there.

    Parameters
    ----------
    frame : StepFrame
        Below and before all of them.
    laws : mapping of str to SampledAdmittance or SampledForce
        By the names of their controllers; all admittances have an inertia, or none has.
    idle : Fraction
        What a sample leaves of the states of idle controllers; nothing where a switch resets them.
    """
    limits = frame.limits
    moving = [law for law in laws.values() if isinstance(law, SampledAdmittance)]
    inert, sprung = any(law.a is not None for law in moving), any(law.Kt for law in moving)
    offset = Value("offset", "r", "rad", limits.angle, "reference over the commanded position")
    integral = _Integral.of(laws.values(), idle, limits)
    following = {"offset": "next_offset", **frame.memory, **integral.memory}
    following |= {"velocity": "next_velocity"} if inert else {}
    gains = (_force_gains(laws.values()), *integral.coefficients)
    force, pulls = _pulled(frame.force) if sprung else (frame.force, ())
    admittances = _admittances(laws.values(), idle)
    ends = (*_hand(limits), *limits.coefficients)
    return StepLaw(
        tuple(laws),
        (*limits.measured, *limits.commanded, HAND),
        (
            offset,
            error_before(2 * BEYOND),
            *([VELOCITY] if inert else []),
            *lags(frame.order),
            *integral.states,
        ),
        (*frame.coefficients, *gains, *admittances, *ends),
        (
            *filtered(frame.order),
            *_correction(frame.force),
            *integral.added,
            *_mixed_reference(integral.correction),
            *motion(limits),
            *pulls,
            *admitted(force, inert=inert),
            Operation("left", "multiply", "d", "offset"),
            Operation("next_offset", "add", "left", "moved", "angle"),
            *integral.advanced,
        ),
        limits.output,
        following,
        UNITS,
    )


def _states(limits: StepLimits, order: int, *, inert: bool, sprung: bool) -> Iterator[Value]:
    angle, meaning = limits.angle, "reference of the motion controller"
    yield Value("reference", "xref", "rad", angle, meaning, starts_at_angle=True)
    yield error_before(2 * angle)
    yield from [VELOCITY] if inert else []
    yield from lags(order)
    if sprung:
        meaning = "reference that the command alone gives"
        yield Value("commanded", "xcom", "rad", angle, meaning, starts_at_angle=True)


def _moving(force: str, *, inert: bool, sprung: bool) -> Iterator[Operation]:
    """Yield admittances with a reference of their own."""
    if sprung:
        yield Operation("offset", "subtract", "reference", "commanded", "term", "r")
        force, pulls = _pulled(force)
        yield from pulls
    yield from admitted(force, inert=inert)
    yield Operation("next_reference", "add", "reference", "moved", "angle")
    if sprung:
        yield Operation("advanced", "multiply", "T", "wanted")
        yield Operation("next_commanded", "add", "commanded", "advanced", "angle")


def _pulled(force: str) -> tuple[str, tuple[Operation, ...]]:
    """Return the force that an admittance takes together with its spring, and how it is made."""
    pull = Operation("pull", "multiply", "Kt", "offset")
    return "felt", (pull, Operation("felt", "add", force, "pull"))


def _admittances(
    laws: Collection[SampledLaw], idle: Fraction | None = None
) -> Iterator[Coefficient]:
    """Yield coefficients for every mode; beside others, ``idle`` is left of the states."""
    each = [law if isinstance(law, SampledAdmittance) else None for law in laws]
    if idle is not None:
        yield Coefficient("takes_offset", "", "1", tuple(ONE if law else ZERO for law in each))
        yield Coefficient("d", "d", "1", tuple(ONE if law else idle for law in each))
    if any(law.Kt for law in each if law):
        yield Coefficient("Kt", "Kt", "N*m/rad", tuple(law.Kt if law else ZERO for law in each))
    kept = tuple(a for a in (law.a if law else idle for law in each) if a is not None)
    if any(law.a is not None for law in each if law):
        yield Coefficient("a", "a", "1", kept)
    yield Coefficient("b", "b", "rad/(s*N*m)", tuple(law.b if law else ZERO for law in each))
    # All admittances have the same period.
    steps = tuple(law.T if law else ZERO for law in each)
    yield Coefficient("T", "T", "s", steps[:1] if idle is None else steps)


def _hand(limits: StepLimits) -> Iterator[Coefficient]:
    yield Coefficient("velocity_limit", "", "rad/s", (limits.velocity,))


def _force_gains(laws: Iterable[SampledLaw]) -> Coefficient:
    gains = (law.Kp if isinstance(law, SampledForce) else ZERO for law in laws)
    return Coefficient("Kf", "Kp", "rad/(N*m)", tuple(gains))


def _correction(force: str) -> Iterator[Operation]:
    yield Operation("lack", "subtract", "wanted_torque", force)
    yield Operation("correction", "multiply", "Kf", "lack")


def _mixed_reference(correction: str) -> Iterator[Operation]:
    yield Operation("taken", "multiply", "takes_offset", "offset")
    yield Operation("off", "add", "taken", correction)
    yield Operation("reference", "add", "position", "off", "angle")


@dataclass(frozen=True, slots=True)
class _Integral:
    """The integral of the force error, in the reference of every mode; empty where there is none.

    It goes on where the force is controlled with it, and bleeds in all other modes.
    """

    correction: str = "correction"
    states: tuple[Value, ...] = ()
    coefficients: tuple[Coefficient, ...] = ()
    added: tuple[Operation, ...] = ()
    advanced: tuple[Operation, ...] = ()
    memory: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, laws: Collection[SampledLaw], idle: Fraction, limits: StepLimits) -> _Integral:
        if not any(_gathers(law) for law in laws):
            return cls()
        return cls(
            "aimed",
            (Value("integral", "w", "rad", limits.angle, "integral of the force error"),),
            tuple(_integral_gains(laws, idle)),
            (Operation("aimed", "add", "integral", "correction"),),
            (
                Operation("bleeding", "multiply", "bled", "integral"),
                Operation("gathered", "multiply", "Ki_T", "lack"),
                Operation("next_integral", "add", "bleeding", "gathered"),
            ),
            {"integral": "next_integral"},
        )


def _gathers(law: SampledLaw) -> bool:
    return isinstance(law, SampledForce) and law.Ki_T != 0


def _integral_gains(laws: Collection[SampledLaw], idle: Fraction) -> Iterator[Coefficient]:
    gains = tuple(law.Ki_T if isinstance(law, SampledForce) else ZERO for law in laws)
    yield Coefficient("Ki_T", "Ki_T", "rad/(N*m)", gains)
    yield Coefficient("bled", "g", "1", tuple(ONE if _gathers(law) else idle for law in laws))
