"""One sample of the shipped law as a list of operations: PD control below the compliant laws.

The order, and every rounding, are those of `nrs_design.controllers.sampled`.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.controllers.sampled import (
    SampledAdmittance,
    SampledForce,
    SampledLaw,
    SampledMotion,
)
from nrs_design.controllers.sensor import SampledLowPass
from nrs_design.controllers.step_parts import (
    BEYOND,
    HAND,
    VELOCITY,
    StepLimits,
    admitted,
    error_before,
    felt,
    filtered,
    lags,
    motion_coefficients,
    next_lags,
)
from nrs_design.controllers.step_parts import motion as motion_operations

UNITS = {"command": "rpm"}
ONE, ZERO = Fraction(1), Fraction(0)


def build_step_law(
    motion: SampledMotion,
    laws: Mapping[str, SampledAdmittance],
    low_pass: SampledLowPass | None = None,
    limits: StepLimits | None = None,
) -> StepLaw:
    """Write impedance control out, operation by operation.

    Parameters
    ----------
    motion : SampledMotion
        The motion controller.
    laws : mapping of str to SampledAdmittance
        By the names of their controllers; all have a virtual inertia, or none has.
    low_pass : SampledLowPass or None
        Through which the force passes on its way to them.
    limits : StepLimits, optional
        Without them, nothing saturates and inputs are refused where no robot gets.
    """
    limits = limits or StepLimits()
    inert = any(law.a is not None for law in laws.values())
    sprung = any(law.Kt for law in laws.values())
    order = 0 if low_pass is None else low_pass.order
    following = {"reference": "next_reference", "error_before": "error", **next_lags(order)}
    following |= {"velocity": "next_velocity"} if inert else {}
    following |= {"commanded": "next_commanded"} if sprung else {}
    coefficients = [*motion_coefficients(motion, low_pass), *_admittances(laws), *_hand(limits)]
    return StepLaw(
        tuple(laws),
        (*limits.measured, HAND),
        tuple(_states(limits, order, inert=inert, sprung=sprung)),
        (*coefficients, *limits.coefficients),
        (
            *filtered(order),
            *motion_operations(limits),
            *_moving(felt(order), inert=inert, sprung=sprung),
        ),
        limits.output,
        following,
        UNITS,
    )


def build_placed_law(
    motion: SampledMotion,
    laws: Mapping[str, SampledForce],
    low_pass: SampledLowPass | None = None,
    limits: StepLimits | None = None,
) -> StepLaw:
    """Write position and force control out; neither has a reference of its own.

    Parameters
    ----------
    motion : SampledMotion
        The motion controller.
    laws : mapping of str to SampledForce
        By the names of their controllers.
    low_pass : SampledLowPass or None
        Through which the force passes on its way to them.
    limits : StepLimits, optional
        Without them, nothing saturates and inputs are refused where no robot gets.
    """
    limits = limits or StepLimits()
    order = 0 if low_pass is None else low_pass.order
    coefficients = (*motion_coefficients(motion, low_pass), _force_gains(laws))
    place = Operation("reference", "add", "position", "correction", "angle")
    return StepLaw(
        tuple(laws),
        (*limits.measured, *limits.commanded),
        (error_before(2 * BEYOND), *lags(order)),
        (*coefficients, *limits.coefficients),
        (*filtered(order), *_correction(felt(order)), place, *motion_operations(limits)),
        limits.output,
        {"error_before": "error", **next_lags(order)},
        UNITS,
    )


def build_mixed_law(
    motion: SampledMotion,
    laws: Mapping[str, SampledLaw],
    idle: Fraction,
    low_pass: SampledLowPass | None = None,
    limits: StepLimits | None = None,
) -> StepLaw:
    """Write impedance control beside position and force control out.

    The reference of impedance control is counted from the commanded position. While another
    controller is active, it and the velocity of the admittances decay. A product with zero or one
    is exact, and so is a sum with zero: what is absent in a mode rounds nothing there.

    Parameters
    ----------
    motion : SampledMotion
        The motion controller.
    laws : mapping of str to SampledAdmittance or SampledForce
        By the names of their controllers; no admittance has a spring, and all have an inertia or
        none has.
    idle : Fraction
        What a sample leaves of the states of idle controllers.
    low_pass : SampledLowPass or None
        Through which the force passes on its way to them.
    limits : StepLimits, optional
        Without them, nothing saturates and inputs are refused where no robot gets.
    """
    limits = limits or StepLimits()
    order = 0 if low_pass is None else low_pass.order
    each = {n: law if isinstance(law, SampledAdmittance) else None for n, law in laws.items()}
    inert = any(law is not None and law.a is not None for law in each.values())
    offset = Value("offset", "r", "rad", limits.angle, "reference over the commanded position")
    following = {"offset": "next_offset", "error_before": "error", **next_lags(order)}
    following |= {"velocity": "next_velocity"} if inert else {}
    coefficients = [
        *motion_coefficients(motion, low_pass),
        _force_gains(laws),
        *_idle_admittances(each.values(), idle, inert=inert),
        *_hand(limits),
    ]
    return StepLaw(
        tuple(laws),
        (*limits.measured, *limits.commanded, HAND),
        (offset, error_before(2 * BEYOND), *([VELOCITY] if inert else []), *lags(order)),
        (*coefficients, *limits.coefficients),
        (
            *filtered(order),
            *_mixed_reference(felt(order)),
            *motion_operations(limits),
            *admitted(felt(order), inert=inert),
            Operation("left", "multiply", "d", "offset"),
            Operation("next_offset", "add", "left", "moved", "angle"),
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


def _mixed_reference(force: str) -> Iterator[Operation]:
    yield from _correction(force)
    yield Operation("taken", "multiply", "takes_offset", "offset")
    yield Operation("off", "add", "taken", "correction")
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
