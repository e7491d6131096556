"""A robot that follows commands by dynamics of its own, or that takes torques.

Its joint moves by ``z' = A z + B u`` under the command u, where the deflection is the last of the
states z and the velocity, unless it jumps, is the first.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction

from nrs_design.errors import AssemblyError
from nrs_design.models.axis import AxisType
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import ONE, ZERO
from nrs_design.models.motion_loop import MotionLoop

Rows = tuple[tuple[Fraction, ...], ...]
OMEGA = "omega [rad/s]"
# Symbols of the stiffness and the damping of what a joint touches.
LOAD = ("k", "b")
# Symbols of the decay rate and the following rate of an environment memory, in 1/s.
MEMORY = ("r1", "r2")
# Symbol of the gain of a motor.
GAIN = "Km"


class CommandInterface(StrEnum):
    """Kind of command of a robot."""

    VELOCITY = "velocity"
    POSITION = "position"
    TORQUE = "torque"


# Units of commands to robots with drives of their own.
COMMANDS: Mapping[CommandInterface, str] = {
    CommandInterface.VELOCITY: "rad/s",
    CommandInterface.POSITION: "rad",
    CommandInterface.TORQUE: "N*m",
}


def find_interface(command: str) -> CommandInterface | None:
    """Return the command interface with a unit; None for commands of a motor."""
    pairs = (
        (axis.unit(unit), interface) for interface, unit in COMMANDS.items() for axis in AxisType
    )
    return dict(pairs).get(command)


@dataclass(frozen=True, slots=True)
class MultiAffine:
    """A matrix that is affine in each of some numbers: constants times products of them."""

    __eq__, __hash__ = object.__eq__, object.__hash__

    # By the symbols of the numbers that a product has, each once; all of one shape.
    terms: Mapping[tuple[str, ...], Rows]

    def slope(self, symbol: str) -> MultiAffine:
        """Return the derivative by one of the numbers."""
        return MultiAffine(
            {
                tuple(s for s in symbols if s != symbol): rows
                for symbols, rows in self.terms.items()
                if symbol in symbols
            }
        )


@dataclass(frozen=True, slots=True)
class Drive:
    """What a joint does with its command."""

    __eq__, __hash__ = object.__eq__, object.__hash__

    interface: CommandInterface | None  # None for the commands of a motor
    states: tuple[str, ...]  # Names and units; the velocity first, the deflection left out
    # [A, B] over the states and the deflection; a velocity that jumps with the command is no state.
    rates: MultiAffine
    ranges: Mapping[str, Interval]  # Ranges of the numbers in `rates`, but for the load
    inverse: frozenset[str] = frozenset()  # Symbols of numbers that `rates` inverts
    loaded: bool = False  # The environment may act on the joint, by the symbols of `LOAD`
    # The velocity by the same states and the command, where it jumps.
    speed: MultiAffine | None = None
    # Name of the last state, if the environment has a memory.
    memory: str | None = None

    @property
    def order(self) -> int:
        """How many states `rates` is about, the deflection counted."""
        return len(self.states) + (self.speed is None)

    def remembering(self, memory: str, rates: Sequence[Interval]) -> Drive:
        """Return the drive with the memory state d of an environment, at the rates r1 and r2.

        ``d' = r2 (delta - d) - r1 d``, and the spring of what is touched has the length delta - d.
        """
        n = self.order

        def widened(
            M: MultiAffine, extra: Mapping[tuple[str, ...], Sequence[Fraction]]
        ) -> MultiAffine:
            """Put in a column for d before that of delta, and a row before the last one."""
            terms: dict[tuple[str, ...], Rows] = {}
            for symbols, rows in M.terms.items():
                pulled = -ONE if LOAD[0] in symbols else ZERO
                full = [(*r[: n - 1], pulled * r[n - 1], *r[n - 1 :]) for r in rows]
                terms[symbols] = (*full[:-1], (ZERO,) * (n + 2), full[-1]) if extra else tuple(full)
            for symbols, row in extra.items():
                blank = (ZERO,) * (n + 2)
                terms[symbols] = (*[blank] * (n - 1), tuple(row), blank)
            return MultiAffine(terms)

        memory_rows = {name: [ZERO] * (n + 2) for name in MEMORY}
        memory_rows[MEMORY[0]][n - 1] = memory_rows[MEMORY[1]][n - 1] = -ONE
        memory_rows[MEMORY[1]][n] = ONE
        return replace(
            self,
            states=(*self.states, memory),
            rates=widened(self.rates, {(name,): row for name, row in memory_rows.items()}),
            speed=None if self.speed is None else widened(self.speed, {}),
            ranges={**self.ranges, **dict(zip(MEMORY, rates, strict=True))},
            memory=memory,
        )

    def fix_values(self, values: Mapping[str, Fraction]) -> Drive:
        """Return the drive at fixed values; symbols without a value take their nominal value."""
        known = {s: Interval.point(values.get(s, r.nominal)) for s, r in self.ranges.items()}
        return replace(self, ranges=known)

    def scaled(self, scale: Fraction) -> Drive:
        """Return the drive, its ranges stretched about nominal values; all must stay positive."""
        ranges = {symbol: interval.scaled(scale) for symbol, interval in self.ranges.items()}
        if any(interval.low <= 0 for interval in ranges.values()):
            raise AssemblyError(
                f"with its ranges scaled by {float(scale):.6g}, the robot does not stay physical",
                remedy="scale the ranges by less",
            )
        return replace(self, ranges=ranges)


def motor_drive(gain: Interval, time_constant: Interval, load: Fraction | None = None) -> Drive:
    """Return a motor ``tau omega' = Km u - omega - tau (k delta + b omega)/J``.

    tau is in s, Km in rad/s per unit of the command, the load J at the joint in kg m^2; without
    one, the last term is left out.
    """
    nothing = (ZERO, ZERO, ZERO)
    rows: dict[tuple[str, ...], Rows] = {
        ("tau",): ((-ONE, ZERO, ZERO), nothing),
        (GAIN, "tau"): ((ZERO, ZERO, ONE), nothing),
        (): (nothing, (ONE, ZERO, ZERO)),
    }
    if load is not None:
        rows[LOAD[:1]] = (ZERO, -1 / load, ZERO), nothing
        rows[LOAD[1:]] = (-1 / load, ZERO, ZERO), nothing
    ranges = {GAIN: gain, "tau": time_constant}
    loaded = load is not None
    return Drive(None, (OMEGA,), MultiAffine(rows), ranges, frozenset({"tau"}), loaded)


def torque_drive(inertia: Interval, friction: Interval) -> Drive:
    """Return a joint that takes torques: ``J omega' = u - B omega - k delta - b omega``.

    The inertia J is in kg m^2, the friction B in N m s/rad.
    """
    rows = {
        ("J", "B"): ((-ONE, ZERO, ZERO), (ZERO, ZERO, ZERO)),
        ("J", LOAD[1]): ((-ONE, ZERO, ZERO), (ZERO, ZERO, ZERO)),
        ("J", LOAD[0]): ((ZERO, -ONE, ZERO), (ZERO, ZERO, ZERO)),
        ("J",): ((ZERO, ZERO, ONE), (ZERO, ZERO, ZERO)),
        (): ((ZERO, ZERO, ZERO), (ONE, ZERO, ZERO)),
    }
    ranges = {"J": inertia, "B": friction}
    return Drive(
        CommandInterface.TORQUE, (OMEGA,), MultiAffine(rows), ranges, frozenset({"J"}), loaded=True
    )


def lagging_drive(time_constant: Interval) -> Drive:
    """Return a joint that follows a position by ``tau theta' = u - theta``, tau in s.

    Its velocity jumps with the command.
    """
    row: Mapping[tuple[str, ...], Rows] = {("tau",): ((-ONE, ONE),)}
    return Drive(
        CommandInterface.POSITION,
        (OMEGA,),
        MultiAffine(row),
        {"tau": time_constant},
        frozenset({"tau"}),
        speed=MultiAffine(row),
    )


def velocity_drive(loop: MotionLoop) -> Drive:
    """Return a joint whose velocity follows the command by a strictly proper transfer function.

    In the observable canonical form, whose first state is the velocity.
    """
    A, B = _observable(loop)
    n = len(A)
    rates = [(*row, ZERO, b) for row, b in zip(A, B, strict=True)]
    way = (ONE, *(ZERO,) * (n + 1))
    return Drive(CommandInterface.VELOCITY, _states(n), MultiAffine({(): (*rates, way)}), {})


def position_drive(loop: MotionLoop) -> Drive:
    """Return a joint whose position follows the command by a strictly proper transfer function.

    In the observable canonical form, whose first state is the position; the others are counted from
    what they are at rest there, so that the second one is the velocity if that does not jump. A
    joint that does not come to rest where it is commanded is refused.
    """
    if loop.numerator[-1] != loop.denominator[-1] or not loop.denominator[-1]:
        raise AssemblyError(
            "the robot does not come to rest where it is commanded: its transfer function is not 1 "
            "at s = 0",
            remedy="let the last coefficients of numerator and denominator be equal",
            at=("position_interface", "transfer_function"),
        )
    A, B = _observable(loop)
    n = len(A)
    # At rest at 1 under the command 1: of 0 = A z + B, from the first row on.
    steady_state = [ONE]
    for row, b in zip(A[:-1], B[:-1], strict=True):
        steady_state.append(-row[0] - b)
    # In z~ = z - steady_state * position, each row loses its share of the position rate. The
    # position becomes the last state.
    first, *others = (
        [sum((a * r for a, r in zip(row, steady_state, strict=True)), ZERO), *row[1:], b]
        for row, b in zip(A, B, strict=True)
    )
    shifted = (
        [a - r * f for a, f in zip(row, first, strict=True)]
        for row, r in zip(others, steady_state[1:], strict=True)
    )
    rates = [(*row[1:-1], row[0], row[-1]) for row in (*shifted, first)]
    jumps = B[0] != 0
    names = _states(n if jumps else n - 1)
    speed = MultiAffine({(): (rates[-1],)}) if jumps else None
    return Drive(CommandInterface.POSITION, names, MultiAffine({(): tuple(rates)}), {}, speed=speed)


def _states(n: int) -> tuple[str, ...]:
    """Name the velocity, and states of the robot that have no unit of their own."""
    return (OMEGA, *(f"xp{i}" for i in range(2, n + 1)))


def _observable(loop: MotionLoop) -> tuple[list[list[Fraction]], list[Fraction]]:
    """Return A and B of ``z' = A z + B u``, ``y = z_1``."""
    lead, *tail = loop.denominator
    n = len(tail)
    padded: Sequence[Fraction] = (*(ZERO,) * (n - len(loop.numerator)), *loop.numerator)
    A = [[-tail[i] / lead, *(Fraction(int(j == i + 1)) for j in range(1, n))] for i in range(n)]
    return A, [c / lead for c in padded]
