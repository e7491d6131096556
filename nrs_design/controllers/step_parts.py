"""What the steps of all laws are put together from: values, coefficients and operations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from nrs_design.controllers.operations import Coefficient, Operation, Value
from nrs_design.controllers.sampled import SampledMotion
from nrs_design.controllers.sensor import SampledLowPass

# Where a spec says nothing: no robot gets there, and nothing overflows.
BEYOND = Fraction(1_000_000)


@dataclass(frozen=True, slots=True)
class StepLimits:
    """Where inputs are refused and where signals saturate; single-precision numbers."""

    angle: Fraction = BEYOND  # Joint angle and reference beyond it are refused, rad
    velocity: Fraction = BEYOND  # The velocity command saturates there, rad/s
    # The speed command of the motor saturates there, rpm; None for nowhere.
    command: Fraction | None = None

    @property
    def measured(self) -> tuple[Value, ...]:
        """What is measured: the angle of the joint, and the torque."""
        return (
            Value("angle", "theta", "rad", self.angle, "measured angle of the joint", "angle"),
            Value("torque", "F", "N*m", BEYOND, "measured torque of the contact", "term"),
        )

    @property
    def commanded(self) -> tuple[Value, ...]:
        """What position and force control are given."""
        return (
            Value("position", "X", "rad", self.angle, "commanded position", "angle"),
            Value("wanted_torque", "Fd", "N*m", BEYOND, "wanted torque of the contact"),
        )

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Where the motor's command saturates, if it does."""
        if self.command is None:
            return ()
        return (Coefficient("command_limit", "", "rpm", (self.command,)),)

    @property
    def output(self) -> dict[str, str]:
        """The motor's command, and the result that it is."""
        return {"command": "command" if self.command is None else "limited_command"}


# What the hand commands, and at which velocity that saturates.
HAND = Value("velocity_command", "v", "rad/s", BEYOND, "velocity that the hand commands")
VELOCITY = Value("velocity", "vm", "rad/s", BEYOND, "velocity of the admittance")


def error_before(limit: Fraction) -> Value:
    """Return the memory of the motion controller; two angles are apart by that limit at most."""
    return Value("error_before", "e before", "rad", limit, "error of motion a sample ago")


@dataclass(frozen=True, slots=True)
class StepFrame:
    """What all laws of a program have in common."""

    motion: SampledMotion  # The motion controller below them
    low_pass: SampledLowPass | None = None  # Through which the force passes on its way to them
    # By default nothing saturates, and inputs are refused where no robot gets.
    limits: StepLimits = StepLimits()

    @property
    def order(self) -> int:
        """How many lags the filter of the force has."""
        return 0 if self.low_pass is None else self.low_pass.order

    @property
    def force(self) -> str:
        """The name of the force that the laws take."""
        return felt(self.order)

    @property
    def coefficients(self) -> tuple[Coefficient, ...]:
        """Those of the motion controller and of the filter of the force."""
        held = {"p": self.low_pass.p, "q": self.low_pass.q} if self.low_pass is not None else {}
        return (
            Coefficient("Kp", "Kp", "rpm/rad", (self.motion.Kp,)),
            Coefficient("Kd_over_T", "D", "rpm/rad", (self.motion.D,)),
            *(Coefficient(name, name, "1", (number,)) for name, number in held.items()),
        )

    @property
    def memory(self) -> dict[str, str]:
        """The states of motion controller and filter, and the results that follow them."""
        lagging = {f"filtered_{i}": felt(i) for i in range(1, self.order + 1)}
        return {"error_before": "error", **lagging}


def motion(limits: StepLimits) -> Iterator[Operation]:
    """Yield the PD controller, from ``reference`` and ``angle`` to ``command``."""
    yield Operation("error", "subtract", "reference", "angle", "own", "e")
    yield Operation("proportional", "multiply", "Kp", "error")
    yield Operation("change", "subtract", "error", "error_before")
    yield Operation("derivative", "multiply", "Kd_over_T", "change")
    yield Operation("command", "add", "proportional", "derivative")
    if limits.command is not None:
        yield Operation("limited_command", "saturate", "command_limit", "command")


def lags(order: int) -> Iterator[Value]:
    """Yield the states of a filter with so many lags."""
    for i in range(1, order + 1):
        yield Value(f"filtered_{i}", f"x{i}", "N*m", BEYOND, f"torque behind lag {i} of the filter")


def felt(order: int) -> str:
    """Return the name of the force behind so many lags."""
    return f"next_filtered_{order}" if order else "torque"


def filtered(order: int) -> Iterator[Operation]:
    """Yield the lags of a filter, one after the other."""
    for i in range(1, order + 1):
        yield Operation(f"kept_{i}", "multiply", "p", f"filtered_{i}")
        yield Operation(f"added_{i}", "multiply", "q", felt(i - 1))
        yield Operation(felt(i), "add", f"kept_{i}", f"added_{i}")


def admitted(force: str, *, inert: bool) -> Iterator[Operation]:
    """Yield an admittance, from a force to ``moved``: by how much it moves the reference."""
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
