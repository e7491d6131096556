"""The closed motion loop of one axis: commanded to actual velocity, or position to position."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.errors import AssemblyError
from nrs_design.models.actuator import Actuator
from nrs_design.models.linear_form import ONE, LinearForm, combine, coordinates, zero


@dataclass(frozen=True, slots=True)
class MotionLoop:
    """An exact strictly proper transfer function G(s)."""

    # numerator, denominator: coefficients, highest power first.
    numerator: tuple[Fraction, ...]
    denominator: tuple[Fraction, ...]
    is_stated: bool = False  # By the spec; else it follows from actuator and motion gains

    @property
    def delay(self) -> Fraction:
        """Delay of slow signals in s: minus the slope of the phase at 0."""
        (*_, b1, b0), (*_, a1, a0) = (Fraction(0), *self.numerator), self.denominator
        return Fraction(0) if not a0 or not b0 else a1 / a0 - b1 / b0


@dataclass(frozen=True, slots=True)
class Realization:
    """Controllable canonical form ``xp' = A xp + B u``, ``y = C xp`` with ``B = [0, ..., 1]'``."""

    A: tuple[tuple[Fraction, ...], ...]
    C: tuple[Fraction, ...]

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.C)

    @property
    def states(self) -> tuple[str, ...]:
        """Names of the states; they have no unit of their own."""
        return tuple(f"xp{i + 1}" for i in range(self.order))

    def output(self, size: int) -> LinearForm:
        """Return y as a linear form of a state of that size, in which xp stands first."""
        return [*self.C, *zero(size - self.order)]

    def rates(self, command: LinearForm, load: LinearForm | None = None) -> list[LinearForm]:
        """Return xp' under the command u; the load, a torque, does not act on this loop."""
        rows = [[*row, *zero(len(command) - self.order)] for row in self.A]
        return [*rows[:-1], combine((ONE, rows[-1]), (ONE, command))]

    def velocity(self, nothing: LinearForm, command: Callable[[], LinearForm]) -> LinearForm:
        """Return y'; `nothing` is the form zero, `command` returns u."""
        needed = command() if self.C[-1] else nothing
        return combine(*zip(self.C, self.rates(needed), strict=True))

    def integral(self, output: LinearForm) -> LinearForm:
        """Return the integral of the command u, which follows from that of the output y.

        Both are zero at rest in the state zero. From the last row of A, with
        ``u = xn' + a[n-1] xn + ... + a0 x1`` and ``y = c0 x1 + c1 x2 + ...``, where ``xi+1 = xi'``,
        the integral of u is ``xn + a[n-1] xn-1 + ... + a1 x1`` plus a0 times that of x1. A loop
        whose output does not move with a lasting command has none: an `AssemblyError`.
        """
        first, *tail = self.C
        if first == 0:
            raise AssemblyError(
                "the motion loop does not follow a lasting command: its gain at zero is zero",
                remedy="give it a numerator with a constant term",
            )
        share = -self.A[-1][0] / first
        row = [-a - share * c for a, c in zip(self.A[-1][1:], tail, strict=True)]
        form = [*row, ONE, *zero(len(output) - self.order)]
        return combine((ONE, form), (share, output))


@dataclass(frozen=True, slots=True)
class JointMotionLoop:
    """PD loop around the actuator in its physical state: the error e and the velocity omega.

    ``e' = u - omega`` and ``tau omega' = Km (Kp e + Kd (u - omega)) - omega - tau F/J``, u the
    commanded velocity and F the torque of the environment. Error and velocity are continuous
    whatever gain and time constant do, which the canonical form is not true of; and the rates are
    affine in Km, 1/tau and 1/J, each for itself.
    """

    order: ClassVar[int] = 2  # Number of states
    states: ClassVar[tuple[str, ...]] = ("e [rad]", "omega [rad/s]")

    # Kp, Kd: PD gains in rpm/rad and rpm s/rad.
    Kp: Fraction
    Kd: Fraction
    Km: Fraction  # Gain of the actuator in (rad/s)/rpm
    tau: Fraction  # Its time constant in s
    # Inertia at the joint in kg m^2 that the environment works against; None leaves its torque out.
    J: Fraction | None

    def output(self, size: int) -> LinearForm:
        """Return omega as a linear form of a state of that size."""
        return coordinates(size)[1]

    def rates(self, command: LinearForm, load: LinearForm | None = None) -> list[LinearForm]:
        """Return e' and omega' under the commanded velocity u and the torque of the environment."""
        error, omega = coordinates(len(command))[:2]
        slip = combine((ONE, command), (-ONE, omega))
        drive = self.Km / self.tau
        turn = combine((drive * self.Kp, error), (drive * self.Kd, slip), (-1 / self.tau, omega))
        if load is not None and self.J is not None:
            turn = combine((ONE, turn), (-1 / self.J, load))
        return [slip, turn]

    @property
    def position_loop(self) -> LoadedMotionLoop:
        """The same loop, from position to position."""
        return LoadedMotionLoop(self)

    def integral(self, output: LinearForm) -> LinearForm:
        """Return the integral of the command u: the error plus `output`, the integral of omega."""
        return combine((ONE, coordinates(len(output))[0]), (ONE, output))


@dataclass(frozen=True, slots=True)
class LoadedMotionLoop:
    """PD loop around an actuator with a load, from position to position.

    The states are the angle theta and ``w = theta' - (Km Kd/tau) u``, which is continuous where the
    commanded position u jumps: ``tau w' = Km Kp (u - theta) - (1 + Km Kd) theta' - tau F/J``.
    """

    order: ClassVar[int] = 2  # Number of states
    states: ClassVar[tuple[str, ...]] = ("theta [rad]", "w [rad/s]")

    joint: JointMotionLoop

    def output(self, size: int) -> LinearForm:
        """Return theta as a linear form of a state of that size."""
        return coordinates(size)[0]

    def velocity(self, nothing: LinearForm, command: Callable[[], LinearForm]) -> LinearForm:
        """Return theta'; `nothing` is the form zero, `command` returns u."""
        feedthrough = self.joint.Km * self.joint.Kd / self.joint.tau
        return combine((ONE, coordinates(len(nothing))[1]), (feedthrough, command()))

    def rates(self, command: LinearForm, load: LinearForm) -> list[LinearForm]:
        """Return theta' and w' under the commanded position and the torque of the environment."""
        joint, velocity = self.joint, self.velocity(command, lambda: command)
        error = combine((ONE, command), (-ONE, self.output(len(command))))
        turn = combine(
            (joint.Km * joint.Kp / joint.tau, error),
            (-(1 + joint.Km * joint.Kd) / joint.tau, velocity),
        )
        if joint.J is not None:
            turn = combine((ONE, turn), (-1 / joint.J, load))
        return [velocity, turn]


def realize(loop: MotionLoop) -> Realization:
    """Return the minimal realization of a strictly proper motion loop (thesis 6.13-6.14)."""
    n = len(loop.denominator) - 1
    leading = loop.denominator[0]
    if n < 1 or len(loop.numerator) > n or leading == 0:
        raise AssemblyError(
            "the motion loop is not strictly proper",
            remedy="its numerator must have a lower degree than its denominator",
        )
    last = tuple(-c / leading for c in reversed(loop.denominator[1:]))
    shift = tuple(tuple(Fraction(int(j == i + 1)) for j in range(n)) for i in range(n - 1))
    padding = (Fraction(0),) * (n - len(loop.numerator))
    return Realization(
        (*shift, last), tuple(c / leading for c in reversed(loop.numerator)) + padding
    )


def close_motion_loop(actuator: Actuator, Kp: Fraction, Kd: Fraction) -> MotionLoop:
    """Close the PD loop around the actuator (thesis 4.28, 6.1); Kp in rpm/rad, Kd in rpm s/rad."""
    damping, stiffness = Kd * actuator.gain, Kp * actuator.gain
    return MotionLoop((damping, stiffness), (actuator.time_constant, 1 + damping, stiffness))
