"""One sample of the shipped law as a list of operations: PD control below the compliant laws.

The order, and every rounding, are those of `nrs_design.controllers.sampled`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
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
        (*frame.coefficients, *_admittances(laws), *_hand(limits), *limits.coefficients),
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
    integral = _Integral.of(laws, idle, limits)
    place = Operation("reference", "add", "position", integral.correction, "angle")
    return StepLaw(
        tuple(laws),
        (*limits.measured, *limits.commanded),
        (error_before(2 * BEYOND), *lags(frame.order), *integral.states),
        (*frame.coefficients, _force_gains(laws), *integral.coefficients, *limits.coefficients),
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
        By the names of their controllers; no admittance has a spring, and all have an inertia or
        none has.
    idle : Fraction
        What a sample leaves of the states of idle controllers; nothing where a switch resets them.
    """
    limits = frame.limits
    each = {n: law if isinstance(law, SampledAdmittance) else None for n, law in laws.items()}
    inert = any(law is not None and law.a is not None for law in each.values())
    offset = Value("offset", "r", "rad", limits.angle, "reference over the commanded position")
    integral = _Integral.of(laws, idle, limits)
    following = {"offset": "next_offset", **frame.memory, **integral.memory}
    following |= {"velocity": "next_velocity"} if inert else {}
    admittances = _idle_admittances(each.values(), idle, inert=inert)
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
        (*frame.coefficients, _force_gains(laws), *integral.coefficients, *admittances, *ends),
        (
            *filtered(frame.order),
            *_correction(frame.force),
            *integral.added,
            *_mixed_reference(integral.correction),
            *motion(limits),
            *admitted(frame.force, inert=inert),
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
        yield Operation("pull", "multiply", "Kt", "offset")
        yield Operation("felt", "add", force, "pull")
        force = "felt"
    yield from admitted(force, inert=inert)
    yield Operation("next_reference", "add", "reference", "moved", "angle")
    if sprung:
        yield Operation("advanced", "multiply", "T", "wanted")
        yield Operation("next_commanded", "add", "commanded", "advanced", "angle")


def _admittances(laws: Mapping[str, SampledAdmittance]) -> Iterator[Coefficient]:
    each = tuple(laws.values())
    if any(law.Kt for law in each):
        yield Coefficient("Kt", "Kt", "N*m/rad", tuple(law.Kt for law in each))
    kept = tuple(law.a for law in each if law.a is not None)
    if kept:
        yield Coefficient("a", "a", "1", kept)
    yield Coefficient("b", "b", "rad/(s*N*m)", tuple(law.b for law in each))
    yield Coefficient("T", "T", "s", (each[0].T,))


def _hand(limits: StepLimits) -> Iterator[Coefficient]:
    yield Coefficient("velocity_limit", "", "rad/s", (limits.velocity,))


def _force_gains(laws: Mapping[str, SampledLaw]) -> Coefficient:
    gains = (law.Kp if isinstance(law, SampledForce) else ZERO for law in laws.values())
    return Coefficient("Kf", "Kp", "rad/(N*m)", tuple(gains))


def _correction(force: str) -> Iterator[Operation]:
    yield Operation("lack", "subtract", "wanted_torque", force)
    yield Operation("correction", "multiply", "Kf", "lack")


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
    def of(cls, laws: Mapping[str, SampledLaw], idle: Fraction, limits: StepLimits) -> _Integral:
        gains = [law.Ki_T if isinstance(law, SampledForce) else ZERO for law in laws.values()]
        if not any(gains):
            return cls()
        left = tuple(ONE if gain else idle for gain in gains)
        return cls(
            "aimed",
            (Value("integral", "w", "rad", limits.angle, "integral of the force error"),),
            (
                Coefficient("Ki_T", "Ki_T", "rad/(N*m)", tuple(gains)),
                Coefficient("bled", "g", "1", left),
            ),
            (Operation("aimed", "add", "integral", "correction"),),
            (
                Operation("bleeding", "multiply", "bled", "integral"),
                Operation("gathered", "multiply", "Ki_T", "lack"),
                Operation("next_integral", "add", "bleeding", "gathered"),
            ),
            {"integral": "next_integral"},
        )


def _mixed_reference(correction: str) -> Iterator[Operation]:
    yield Operation("taken", "multiply", "takes_offset", "offset")
    yield Operation("off", "add", "taken", correction)
    yield Operation("reference", "add", "position", "off", "angle")


def _idle_admittances(
    laws: Collection[SampledAdmittance | None], idle: Fraction, *, inert: bool
) -> Iterator[Coefficient]:
    """Yield coefficients for every mode; None is one in which admittances are idle."""
    yield Coefficient("takes_offset", "", "1", tuple(ONE if law else ZERO for law in laws))
    yield Coefficient("d", "d", "1", tuple(ONE if law else idle for law in laws))
    if inert:
        kept = (idle if law is None else law.a for law in laws)
        yield Coefficient("a", "a", "1", tuple(a for a in kept if a is not None))
    yield Coefficient("b", "b", "rad/(s*N*m)", tuple(law.b if law else ZERO for law in laws))
    yield Coefficient("T", "T", "s", tuple(law.T if law else ZERO for law in laws))
