"""One sample of the shipped law as a list of operations: PD control below the compliant laws.

The order, and every rounding, are those of `nrs_design.controllers.sampled`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.operations import Coefficient, Operation, StepLaw, Value
from nrs_design.controllers.sampled import SampledAdmittance, SampledForce, SampledMotion
from nrs_design.controllers.sensor import SampledLowPass

# Where a spec says nothing: no robot gets there, and nothing overflows.
BEYOND = Fraction(1_000_000)


@dataclass(frozen=True, slots=True)
class StepLimits:
    """Where inputs are refused and where signals saturate; single-precision numbers.

    Parameters
    ----------
    angle : Fraction
        Joint angle and reference beyond it are refused, rad.
    velocity : Fraction
        The velocity command saturates there, rad/s.
    command : Fraction or None
        The speed command of the motor saturates there, rpm; None for nowhere.
    """

    angle: Fraction = BEYOND
    velocity: Fraction = BEYOND
    command: Fraction | None = None


def build_step_law(
    motion: SampledMotion,
    laws: Mapping[str, SampledAdmittance],
    low_pass: SampledLowPass | None = None,
    limits: StepLimits | None = None,
) -> StepLaw:
    """Write the law out, operation by operation.

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
    admittance = _admittance(_felt(order), inert=inert, sprung=sprung)
    operations = (*_filter(order), *_motion(limits), *admittance)
    following = {"reference": "next_reference", "error_before": "error"}
    following |= {"velocity": "next_velocity"} if inert else {}
    following |= _next_lags(order)
    following |= {"commanded": "next_commanded"} if sprung else {}
    return StepLaw(
        tuple(laws),
        _inputs(limits),
        tuple(_states(limits, order, inert=inert, sprung=sprung)),
        tuple(_coefficients(motion, laws, low_pass, limits)),
        operations,
        _output(limits),
        following,
        {"command": "rpm"},
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
    angle, torque, _ = _inputs(limits)
    position = Value("position", "X", "rad", limits.angle, "commanded position", "angle")
    wanted = Value("wanted_torque", "Fd", "N*m", BEYOND, "wanted torque of the contact")
    states = [Value("error_before", "e before", "rad", 2 * BEYOND, "error of a sample ago")]
    coefficients = [*_motion_coefficients(motion), *_filter_coefficients(low_pass)]
    coefficients.append(
        Coefficient("Kf", "Kp", "rad/(N*m)", tuple(law.Kp for law in laws.values()))
    )
    return StepLaw(
        tuple(laws),
        (angle, torque, position, wanted),
        (*states, *_lags(order)),
        (*coefficients, *_command_limit(limits)),
        (*_filter(order), *_placing(_felt(order)), *_motion(limits)),
        _output(limits),
        {"error_before": "error"} | _next_lags(order),
        {"command": "rpm"},
    )


def _inputs(limits: StepLimits) -> tuple[Value, ...]:
    return (
        Value("angle", "theta", "rad", limits.angle, "measured angle of the joint", "angle"),
        Value("torque", "F", "N*m", BEYOND, "measured torque of the contact", "term"),
        Value("velocity_command", "v", "rad/s", BEYOND, "velocity that the hand commands"),
    )


def _states(limits: StepLimits, order: int, *, inert: bool, sprung: bool) -> Iterator[Value]:
    angle = limits.angle
    meaning = "reference of the motion controller"
    yield Value("reference", "xref", "rad", angle, meaning, starts_at_angle=True)
    yield Value("error_before", "e before", "rad", 2 * angle, "its error a sample ago")
    if inert:
        yield Value("velocity", "vm", "rad/s", BEYOND, "velocity of the admittance")
    yield from _lags(order)
    if sprung:
        meaning = "reference that the command alone gives"
        yield Value("commanded", "xcom", "rad", angle, meaning, starts_at_angle=True)


def _coefficients(
    motion: SampledMotion,
    laws: Mapping[str, SampledAdmittance],
    low_pass: SampledLowPass | None,
    limits: StepLimits,
) -> Iterator[Coefficient]:
    each = tuple(laws.values())
    yield from _motion_coefficients(motion)
    yield from _filter_coefficients(low_pass)
    if any(law.Kt for law in each):
        yield Coefficient("Kt", "Kt", "N*m/rad", tuple(law.Kt for law in each))
    kept = tuple(law.a for law in each if law.a is not None)
    if kept:
        yield Coefficient("a", "a", "1", kept)
    yield Coefficient("b", "b", "rad/(s*N*m)", tuple(law.b for law in each))
    yield Coefficient("T", "T", "s", (each[0].T,))
    yield Coefficient("velocity_limit", "", "rad/s", (limits.velocity,))
    yield from _command_limit(limits)


def _motion_coefficients(motion: SampledMotion) -> Iterator[Coefficient]:
    yield Coefficient("Kp", "Kp", "rpm/rad", (motion.Kp,))
    yield Coefficient("Kd_over_T", "D", "rpm/rad", (motion.D,))


def _filter_coefficients(low_pass: SampledLowPass | None) -> Iterator[Coefficient]:
    if low_pass is not None:
        yield Coefficient("p", "p", "1", (low_pass.p,))
        yield Coefficient("q", "q", "1", (low_pass.q,))


def _command_limit(limits: StepLimits) -> Iterator[Coefficient]:
    if limits.command is not None:
        yield Coefficient("command_limit", "", "rpm", (limits.command,))


def _output(limits: StepLimits) -> dict[str, str]:
    return {"command": "command" if limits.command is None else "limited_command"}


def _lags(order: int) -> Iterator[Value]:
    for i in range(1, order + 1):
        yield Value(f"filtered_{i}", f"x{i}", "N*m", BEYOND, f"torque behind lag {i} of the filter")


def _next_lags(order: int) -> dict[str, str]:
    return {f"filtered_{i}": f"next_filtered_{i}" for i in range(1, order + 1)}


def _felt(order: int) -> str:
    """Return the name of the force that the laws take."""
    return f"next_filtered_{order}" if order else "torque"


def _filter(order: int) -> Iterator[Operation]:
    for i in range(1, order + 1):
        yield Operation(f"kept_{i}", "multiply", "p", f"filtered_{i}")
        yield Operation(f"added_{i}", "multiply", "q", _felt(i - 1))
        yield Operation(_felt(i), "add", f"kept_{i}", f"added_{i}")


def _placing(force: str) -> Iterator[Operation]:
    yield Operation("lack", "subtract", "wanted_torque", force)
    yield Operation("correction", "multiply", "Kf", "lack")
    yield Operation("reference", "add", "position", "correction", "angle")


def _motion(limits: StepLimits) -> Iterator[Operation]:
    yield Operation("error", "subtract", "reference", "angle", "own", "e")
    yield Operation("proportional", "multiply", "Kp", "error")
    yield Operation("change", "subtract", "error", "error_before")
    yield Operation("derivative", "multiply", "Kd_over_T", "change")
    yield Operation("command", "add", "proportional", "derivative")
    if limits.command is not None:
        yield Operation("limited_command", "saturate", "command_limit", "command")


def _admittance(force: str, *, inert: bool, sprung: bool) -> Iterator[Operation]:
    if sprung:
        yield Operation("offset", "subtract", "reference", "commanded", "term", "r")
        yield Operation("pull", "multiply", "Kt", "offset")
        yield Operation("felt", "add", force, "pull")
        force = "felt"
    if inert:
        yield Operation("kept", "multiply", "a", "velocity")
        yield Operation("pushed", "multiply", "b", force)
        yield Operation("next_velocity", "add", "kept", "pushed")
    else:
        yield Operation("velocity", "multiply", "b", force, "own", "vm")
    # The reference moves on with the velocity of before this sample, where it is a state.
    yield Operation("wanted", "saturate", "velocity_limit", "velocity_command")
    yield Operation("relative", "subtract", "wanted", "velocity")
    yield Operation("moved", "multiply", "T", "relative")
    yield Operation("next_reference", "add", "reference", "moved", "angle")
    if sprung:
        yield Operation("advanced", "multiply", "T", "wanted")
        yield Operation("next_commanded", "add", "commanded", "advanced", "angle")
