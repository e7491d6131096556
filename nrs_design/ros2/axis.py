"""One axis of the admittance controller in contact, as an exact difference equation.

In each period the controller smooths the force, ``f = (1-c) f + c F``, and moves by symplectic
Euler: ``v = v + T ((f - D v - K x)/M - d v)``, ``p = p + T v``
(ros2_controllers, ``admittance_rule_impl.hpp``). The robot follows with a lag, ``r = E r + (1-E)
p``, ``E = exp(-T/lag)``; x is where it was some periods ago, and what it touches answers with
``F = -k x``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import isqrt

from nrs_design.controllers.taylor import exponential_between
from nrs_design.loop.parameter_box import Box
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm, combine, coordinates, zero
from nrs_design.proof.contact import Contact
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.ros2.law import AdmittanceLaw, Axis, Range

UNIT = Fraction(1)
# Digits in base two behind the point of a square root that is not rational.
BITS = 80


@dataclass(frozen=True, slots=True)
class ControllerContext:
    """What the controller runs in."""

    # Smallest and largest age of the measured offset and force, in periods.
    delays: tuple[int, int]
    # stiffness, rotational: range of the environment for translations in N/m, and for rotations in
    # N*m/rad.
    stiffness: Range | None
    rotational: Range | None
    # Smallest and largest time constant in s with which the robot follows its command.
    lag: Range = (Fraction(0), Fraction(0))
    period: Fraction = Fraction(0)  # Period of the control loop in s; each controller has its own

    @property
    def lag_decay(self) -> Interval:
        """Enclosure of E, the share of the distance to the command that remains after a period."""
        shares = [
            exponential_between(-self.period / lag) if lag else (Fraction(0), Fraction(0))
            for lag in self.lag
        ]
        return Interval(shares[0][0], shares[0][0], shares[1][1])

    def find_stiffness(self, axis: Axis) -> Range | None:
        """Return the range of stiffness for an axis; None without a range."""
        if not axis.selected:
            return Fraction(0), Fraction(0)
        return self.rotational if axis.rotates else self.stiffness


def square_root_between(value: Fraction) -> Interval:
    """Enclose the square root of a number >= 0; a rational root is a point."""
    p, q = value.numerator, value.denominator
    root = Fraction(isqrt(p * q), q)
    if root * root == value:
        return Interval.point(root)
    lower = Fraction(isqrt(p * q << 2 * BITS), q << BITS)
    return Interval(lower, lower, lower + Fraction(1, q << BITS))


def axis_damping(axis: Axis) -> Interval:
    """Return where the damping of an axis lies, in N*s/m or N*m*s/rad."""
    root, factor = square_root_between(axis.mass * axis.stiffness), 2 * axis.damping_ratio
    ends = sorted((factor * root.low, factor * root.high))
    return Interval(ends[0], ends[0], ends[1])


@dataclass(frozen=True, slots=True)
class _Frame:
    """Map of ``[v, e, steps of the robot, f, delta]`` over one period.

    e is the distance to the command, delta where the robot was at the greatest age; e and f are
    left out where there is no lag and no filter, the steps where nothing is old.
    """

    axis: Axis
    joint_damping: Fraction
    c: Fraction
    context: ControllerContext

    @property
    def smooths(self) -> bool:
        """Whether the smoothed force is a state."""
        return self.axis.selected and self.c != 1

    @property
    def lags(self) -> bool:
        """Whether the robot follows with a lag."""
        return self.context.lag[1] > 0

    @property
    def moves(self) -> bool:
        """Whether anything depends on where the axis is."""
        return self.axis.selected or self.axis.stiffness > 0

    @property
    def states(self) -> tuple[str, ...]:
        """Names and units."""
        place, force = ("rad", "N*m") if self.axis.rotates else ("m", "N")
        speed = f"v [{place}/s]"
        if not self.moves:
            return (speed,)
        lag_state = (f"e [{place}]",) if self.lags else ()
        steps = (f"step {i} before [{place}]" for i in range(self.context.delays[1]))
        smoothed = (f"f [{force}]",) if self.smooths else ()
        return (speed, *lag_state, *steps, *smoothed, f"delta [{place}]")

    def rows(self, age: int, values: Mapping[str, Fraction]) -> list[LinearForm]:
        """Return the map of one period, for an age in periods, and values of k, D and E."""
        T, E, oldest = self.context.period, values["E"], self.context.delays[1]
        unit = coordinates(len(self.states))
        v, delta = unit[0], unit[-1]
        slowed = combine((1 - T * (values["D"] / self.axis.mass + self.joint_damping), v))
        if not self.moves:
            return [slowed]
        lag_state = unit[1] if self.lags else zero(len(unit))
        steps = unit[1 + self.lags :][:oldest]
        measured = combine((UNIT, delta), *((UNIT, step) for step in steps[age:]))
        force, smoothed = combine((-values["k"] * self.c, measured)), []
        if self.smooths:
            force = combine((1 - self.c, unit[-2]), (UNIT, force))
            smoothed = [force]
        gain = T / self.axis.mass
        new = combine((UNIT, slowed), (gain, force), (-gain * self.axis.stiffness, measured))
        ahead = combine((UNIT, lag_state), (T, new))
        moves = [combine((1 - E, ahead)), *steps]
        left = [combine((E, ahead))] if self.lags else []
        return [
            new,
            *left,
            *moves[:oldest],
            *smoothed,
            combine((UNIT, delta), (UNIT, moves[oldest])),
        ]


def close_axis(law: AdmittanceLaw, axis: Axis, context: ControllerContext) -> SwitchedSystem:
    """Assemble the modes of one axis: every age of the measurement, every end of the ranges."""
    low, high = context.find_stiffness(axis) or (Fraction(0), Fraction(0))
    frame = _Frame(axis, law.joint_damping, law.filter_coefficient, context)
    others = Box({"D": axis_damping(axis), "E": context.lag_decay})
    box = Box({"k": Interval(low, low, high)}).join(others)
    modes = tuple(_modes(frame, box, context.delays, "contact"))
    free = None
    if axis.selected and axis.stiffness == 0 and context.delays[0] == context.delays[1]:
        # Without a spring nothing but the environment knows where the axis is.
        no_stiffness = Box({"k": Interval.point(Fraction(0))}).join(others)
        free = Contact(tuple(_modes(frame, no_stiffness, context.delays, "free")))
    return SwitchedSystem(
        name=f"{law.node.name}: axis {axis.name}",
        time=Time.DISCRETE,
        states=frame.states,
        modes=modes,
        assumptions=(),  # See `assumptions`.
        contact=free,
        sample_time=context.period,
    )


def _modes(frame: _Frame, box: Box, delays: tuple[int, int], name: str) -> Iterator[Mode]:
    for delay in range(delays[0], delays[1] + 1) if frame.moves else (0,):
        mode_name = f"{name}/age-{delay}" if delays[0] < delays[1] else name
        for labels, rows in box.corners(partial(frame.rows, delay), mode_name):
            yield Mode("/".join((mode_name, *labels)), RationalMatrix.from_rows(rows))


def assumptions(context: ControllerContext) -> tuple[str, ...]:
    """Return the assumptions of a verdict on an axis."""
    first, last = context.delays
    age = f"{first} periods" if first == last else f"{first} to {last} periods, in any order,"
    tracking = "the robot is where it was commanded to be (--lag)"
    if context.lag[1]:
        ends = " to ".join(f"{float(1000 * lag):g}" for lag in context.lag)
        tracking = f"the robot follows its command with a lag of first order, {ends} ms"
    return (
        "the environment is a spring without damping; its stiffness lies in the range at every "
        "period and may change from period to period; a range from 0 also covers loss and return "
        "of contact at the reference",
        f"the period is always the same; measured offset and force are {age} old",
        tracking,
        "the axes are decoupled: the control frame is aligned with the base (a rotated control "
        "frame is covered for equal masses, and always since ros2_controllers 6.4.0), the Jacobian "
        "is square, regular and constant, and the damped inverse (alpha) equals the exact inverse",
        "the measured force is that of the contact: nothing scales or filters it before this "
        "controller",
        "the parameters are those of this file, and are not changed while the controller runs",
        "nothing is limited on the way, and arithmetic is not rounded",
    )
