"""The axes of a task space at once: what an arm that takes torques makes of the force on each.

Let J be the inertias that the axes are given, u the commands over them, g and k friction and
stiffness over them. With ``y = J^(1/2) (velocities)``,

    y' = S a,    a = u - g y - k (deflections),    S = J^(1/2) Lambda(q)^-1 J^(1/2)

with the eigenvalues of S in [l, u], s near their middle, ``r = max(u - s, s - l)``. So ``h = (S - s
I) a`` has ``sum h_i^2 <= r^2 sum a_i^2`` at every moment, and the means of these squares over the
period, eta_i^2 and alpha_i^2, too. All else is about one axis, so axes need not be alike; divided
by its inertia, G and K are the largest g and k, w_g and w_k how wide they are.

1. Beside the axis alone with the inertia J/s, the difference p has ``p_omega' = -s (g p_omega + k
   p_delta) + h``. As the integral of ``|h|`` up to t is at most ``(t T)^(1/2) eta``, with ``1 - c =
   1 - s T (G + K T)``, if that is positive, ``|p_omega| <= T eta/(1 - c)`` and ``|p_delta| <= (2/3)
   T^2 eta/(1 - c)``.
2. Let a_0 be a where the period begins, with the mean of k and g over it. In the root of the mean
   of squares, as ``|omega - omega(0)| <= (t T)^(1/2) (s alpha + eta)``, ``alpha <= A + nu (s alpha
   + eta)`` with ``A = |a_0| + (w_g + K T/3^(1/2)) |omega(0)| + w_k |delta(0)|`` and ``nu = G
   T/2^(1/2) + K T^2/3``. So ``alpha^2 <= ((1 + nu) A^2 + (1 + nu) nu eta^2)/(1 - s nu)^2``, and
   with ``theta = 1 - r^2 (1 + nu) nu/(1 - s nu)^2``, if that is positive, ``sum theta_i eta_i^2 <=
   sum r^2 (1 + nu_i)/(1 - s nu_i)^2 A_i^2``.
3. For any ``e > 0``, ``A^2 <= (1 + e) a_0^2 + 2 (1 + 1/e) (...)^2 omega(0)^2 + 2 (1 + 1/e) w_k^2
   delta(0)^2``, and for any share v, ``v (p_omega (1 - c)/T)^2 + (1 - v) (p_delta (1 - c) 3/(2
   T^2))^2 <= eta^2``.

So ``sum w_1^2 + w_2^2 <= sum of three squares``, with w_1 and w_2 what remains of p_omega and
p_delta: three couplings of one name, with one multiplier tau. The sums are in y: an axis has there
J_i times what it has by itself, so divided by tau_i and multiplied by J_i, ``sum J_i V_i/tau_i``
falls by the largest rho_i^2 in every step.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, isqrt

from nrs_design.errors import AssemblyError
from nrs_design.models.contact.environment import Environment
from nrs_design.models.drive import Drive
from nrs_design.models.interval import Interval
from nrs_design.models.linear_form import LinearForm, coordinates
from nrs_design.proof.channels import Coupling
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.text import exact_text
from nrs_design.switched.assumption import Assumption, say
from nrs_design.switched.assumptions import UNCOUPLED
from nrs_design.switched.coupled import AT_ONCE, not_below
from nrs_design.switched.sampled_frame import INPUTS, Frame
from nrs_design.switched.sampled_inputs import SampledMode, damping_of, known_entries

ZERO, ONE = Fraction(0), Fraction(1)
NAME = "the mobility of the arm"
# Of the middle of a range, which need not be exact.
LARGEST_DENOMINATOR = 1000
# Weights that may be any: of the error of the speed against that of the way, and of what is left
# out of the acceleration of the sample.
ON_SPEED = Fraction(19, 20)
LITTLE = Fraction(1, 8)
PRECISION = 2**64


@dataclass(frozen=True, slots=True)
class Mobility:
    """What is known of the arm."""

    # lowest, highest: every eigenvalue of S is between them.
    lowest: Fraction
    highest: Fraction
    source: str  # Where the numbers come from

    @property
    def middle(self) -> Fraction:
        """A short number near the middle of the range, and in it."""
        middle = (self.lowest + self.highest) / 2
        short = middle.limit_denominator(LARGEST_DENOMINATOR)
        return short if self.lowest <= short <= self.highest else middle

    @property
    def radius(self) -> Fraction:
        """How far from the middle the range goes."""
        return max(self.highest - self.middle, self.middle - self.lowest)

    def scaled(self, scale: Fraction) -> Mobility:
        """Return it with the range stretched about its middle, above zero.

        Raises
        ------
        AssemblyError
            If it would not stay above zero.
        """
        half = scale * (self.highest - self.lowest) / 2
        middle = (self.lowest + self.highest) / 2
        if half >= middle:
            raise AssemblyError(
                "with its range scaled, the mobility does not stay positive",
                remedy="scale the ranges by less",
                at=("coupling", "mobility"),
            )
        return replace(self, lowest=middle - half, highest=middle + half)

    def mean(self, drive: Drive) -> Drive:
        """Return the drive of an axis with the middle of the mobility: of the inertia J/s."""
        J = drive.ranges["J"].nominal / self.middle
        return replace(drive, ranges={**drive.ranges, "J": Interval.point(J)})

    def couplings(
        self,
        frame: Frame,
        drive: Drive,
        environments: Iterable[Environment],
        motions: Sequence[SampledMode],
    ) -> Iterator[Coupling]:
        """Yield what the other axes do to one within a period; they are bounded together.

        Parameters
        ----------
        frame : Frame
            Of all modes, with the drive of `mean`.
        drive : Drive
            Of the axis, with its own inertia.
        environments : iterable of Environment
            What it may touch.
        motions : sequence of SampledMode
            All modes. Their slip is s times the acceleration of the axis alone.

        Raises
        ------
        AssemblyError
            If the period is too long.
        """
        push = push_of(self, drive, tuple(environments), frame.period)
        n = len(frame.states)
        unit = coordinates(n)
        first = n + len(INPUTS)
        seen = [*known_entries(frame, ()), *range(first, first + len(frame.roundings))]
        wide = coordinates(len(seen))
        omega, delta = frame.states.index("omega [rad/s]"), n - 1
        rows: list[list[LinearForm]] = [
            [[push.acceleration * motion.slip[i] for i in seen] for motion in motions],
            [[push.speed * entry for entry in wide[omega]]] * len(motions),
            [[push.deflection * entry for entry in wide[delta]]] * len(motions),
        ]
        way = list(unit[delta])
        if frame.states[0] == "e [rad]":
            way[0] = -ONE
        columns: list[LinearForm] = [
            [push.on_speed * entry for entry in unit[omega]],
            [push.on_way * entry for entry in way],
            [ZERO] * n,
        ]
        for column, forms in zip(columns, rows, strict=True):
            B = RationalMatrix.from_rows([[entry] for entry in column])
            bound = tuple(RationalMatrix.from_rows([form]) for form in forms)
            yield Coupling(NAME, (B,) * len(motions), bound)

    def among(self, assumptions: Iterable[str]) -> tuple[str, ...]:
        """Return assumptions with what is known of the axes in the place of their being alone."""
        return tuple(
            text
            for known in assumptions
            for text in (self._texts() if known == UNCOUPLED else (known,))
        )

    def _texts(self) -> Iterator[Assumption]:
        low, high = exact_text(self.lowest), exact_text(self.highest)
        yield say("task-space.axes")
        yield say("touched-alone.axis")
        yield say(
            "task-space.mobility",
            f"eigenvalues of S in [{low}, {high}]",
            low=low,
            high=high,
            source=self.source,
        )
        yield say("joint-speed.left-out", "speeds near zero")
        yield say("gravity.all-poses", "all poses that are used")
        yield AT_ONCE


@dataclass(frozen=True, slots=True)
class AxisPush:
    """With ``w1^2 + w2^2`` summed over the axes at most the squares of three numbers summed so.

    Two say how far w moves an axis, three of what the numbers are made.
    """

    on_speed: Fraction
    on_way: Fraction
    acceleration: Fraction  # Times the slip
    speed: Fraction
    deflection: Fraction


def push_of(
    mobility: Mobility, drive: Drive, environments: Sequence[Environment], T: Fraction
) -> AxisPush:
    """Return what the other axes do to one within a period.

    Parameters
    ----------
    mobility : Mobility
        Of the arm.
    drive : Drive
        Of the axis, with its own inertia.
    environments : sequence of Environment
        What it may touch.
    T : Fraction
        The period, in s.

    Raises
    ------
    AssemblyError
        If the period is too long.
    """
    J, r, s = drive.ranges["J"].nominal, mobility.radius, mobility.middle
    stiffness = [e.stiffness for e in environments]
    damping = [damping_of(e) for e in environments]
    K = max((k.high for k in stiffness), default=ZERO) / J
    G = (drive.ranges["B"].high + max((b.high for b in damping), default=ZERO)) / J
    # What is touched may change within the period.
    wide_k = max((k.high - k.low for k in stiffness), default=ZERO) / J
    wide_b = max((b.high - b.low for b in damping), default=ZERO) / J
    # Upper bounds: 5/7 is above 1/sqrt(2), and 3/5 above 1/sqrt(3).
    nu = G * T * Fraction(5, 7) + K * T**2 / 3
    slowing, back = 1 - s * T * (G + K * T), 1 - s * nu
    left = 1 - r**2 * (1 + nu) * nu / back**2 if back > 0 else ZERO
    if slowing <= 0 or left <= 0:
        raise AssemblyError(
            "a period is too long for a bound on what the axes do to each other within it",
            remedy="shorten the period, or leave coupling out",
            at=("coupling",),
        )
    little = ONE if wide_k or wide_b else LITTLE
    size = r**2 * (1 + nu) / back**2
    others = size * 2 * (1 + 1 / little)
    return AxisPush(
        _root(T**2 / (ON_SPEED * left)) / slowing,
        _root((T**2 * 2 / 3) ** 2 / ((1 - ON_SPEED) * left)) / slowing,
        _root(size * (1 + little)) / s,
        _root(others) * (wide_b + K * T * Fraction(3, 5)),
        _root(others) * wide_k,
    )


def _root(square: Fraction) -> Fraction:
    """Return a number of few digits that is not below the root."""
    whole = ceil(square * PRECISION**2)
    return not_below(Fraction(isqrt(max(whole - 1, 0)) + 1, PRECISION)) if whole else ZERO
