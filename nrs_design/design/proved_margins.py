"""Margins over whole ranges, in exact arithmetic.

The worst margin at the corners of all ranges is floating point, and only a proposal: rounded to its
unfavorable side, it is proved for every stiffness and motor in their ranges, each constant. The
open loop is ``N/D``, and ``C = D + N``, exactly (`nrs_design.loop.cut_loop`). On the imaginary
axis:

- ``|S| <= Ms`` is ``|D| <= Ms |C|``, and the disk margin d is ``|D - N| <= 2/d |C|``;
- the gain margin g says that ``D + f N`` keeps its roots on the left for factors f from 1 to g;
- the phase margin p says that ``D + exp(j a) N``, or ``C + j t (N - D)`` with ``t = tan(a/2)``, is
  nowhere zero for ``|a| <= p``;
- the delay margin T says the same of ``a = -omega T'`` with ``0 <= T' <= T``. Below a frequency w,
  t is between 0 and ``-omega tan(w T/2)/w``; beyond the last gain crossover, nothing is zero.

All of it is affine in each parameter, so squares of magnitudes have Bernstein forms.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from math import isfinite, prod

import numpy as np

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.design import measures
from nrs_design.design.affine_family import (
    ONE,
    ZERO,
    FrequencyPiece,
    Polynomial,
    Response,
    Square,
    Squares,
    corners_in,
    everywhere,
    find_motor,
    is_stable_over,
    parts_on_axis,
    polynomial,
    squared_magnitude,
)
from nrs_design.design.goals import Achieved
from nrs_design.design.measures import GoalStanding, Measure
from nrs_design.design.transfer import frequencies
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.loop.hull import rational
from nrs_design.models.contact import Elastic, KelvinVoigt
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from nrs_design.proof.enclosure import ball_around, fraction_of, precision

_RANGES = 4  # Ranges at once
# Beyond the worst value at the corners: between them it may be worse.
_SLACK = (ZERO, Fraction(1, 1000), Fraction(1, 100))
_DIGITS = 4
# Pieces of the frequencies of a delay, and how far beyond the last crossover they go.
_PIECES, _CLEARANCE = 6, Fraction(1_000_001, 1_000_000)


@dataclass(frozen=True)
class RangedLoop:
    """The loops of one controller in one environment, over all ranges."""

    axis: ContinuousAxis  # From which the modes follow
    law: CompliantLaw  # With the gains that ship
    environment: Environment  # With any linear law
    ranges: Mapping[str, Interval]  # Ranges of ``Km`` and ``tau``
    desired: Fraction = ONE  # Desired impedance, N m s/rad
    bandwidth: Fraction = ONE  # Highest frequency of the command, rad/s

    @property
    def box(self) -> dict[str, Interval]:
        """The ranges that are more than one value."""
        given = {**self.ranges, **self.environment.parameters}
        return {name: r for name, r in given.items() if r.low != r.high}

    @cached_property
    def stable(self) -> bool:
        """True if the loop is proved stable in the whole box."""
        return self._stays_stable(ONE)

    def holds(self, measure: Measure, value: Fraction) -> bool:
        """Tell whether a stable loop is shown to have nowhere in the box a worse value, in SI.

        The measure is one of `PROVABLE`, its value positive.
        """
        return _PROOFS[measure](self, value)

    def _cut_loop(
        self, values: Mapping[str, Fraction], *, is_held: bool = False
    ) -> tuple[Polynomial, Polynomial]:
        """Return D and C, affine in each parameter.

        Each parameter is in the force, or in one row of the matrix: in that of the motor, the law
        or the memory of the contact, which are multiplied by what they are divided by. The force is
        one linear form of the state, and where it is in several rows, their determinant is affine
        in it all the same.

        `held`: D is that of nothing touched, for a hand that holds the robot.
        """
        place, factor = find_motor(self.axis, values)
        contact = self._contact(values)
        factor *= rational(
            prod((contact[name] for name in self.environment.law.inverse), start=ONE)
        )
        loop = self.axis.find_loop(self.law, self.environment.evaluate(contact), place)
        first = loop.free if is_held else loop.opened
        return factor * polynomial(*first), factor * polynomial(*loop.closed)

    def _contact(self, values: Mapping[str, Fraction]) -> dict[str, Fraction]:
        return {name: r.low for name, r in self.environment.parameters.items()} | {**values}

    def _stays_stable(self, gain: Fraction) -> bool:
        """Tell whether ``D + f N`` keeps its roots on the left for f from 1 to a gain."""

        def poles(values: Mapping[str, Fraction]) -> tuple[Polynomial]:
            opened, closed = self._cut_loop(values)
            return (opened + rational(values.get("factor", ONE)) * (closed - opened),)

        box = self.box | ({"factor": Interval(ONE, ONE, gain)} if gain > 1 else {})
        return gain >= 1 and is_stable_over(poles, box)

    def _has_sensitivity(self, peak: Fraction) -> bool:
        return self._stays_below(lambda d, c: (d, c), peak)

    def _has_disk(self, margin: Fraction) -> bool:
        return self._stays_below(lambda d, c: (2 * d - c, c), 2 / margin)

    def _has_impedance(self, error: Fraction) -> bool:
        """Tell whether ``N/(H Y C)`` is within a factor of the desired impedance in the band."""
        # A spring is displayed without bound towards rest.
        if self.law.gains.get("Kt"):
            return False
        factor, band = self._over_admittance(), self.bandwidth
        return self._stays_below(
            lambda d, c: ((c - d) * factor, c), error * self.desired, band
        ) and self._stays_below(lambda d, c: (c, (c - d) * factor), error / self.desired, band)

    def _over_admittance(self) -> Polynomial:
        """Return ``1/(H Y)`` of a law without a spring."""
        law, low_pass = polynomial(self.law.gains["Mt"], self.law.gains["Bt"]), self.axis.low_pass
        if low_pass is None:
            return law
        return law * polynomial(1 / low_pass.pole, ONE) ** low_pass.order

    def _has_transparency(self, share: Fraction) -> bool:
        """Tell whether ``N/C`` is nowhere below a share in the band."""
        return self._stays_below(lambda d, c: (c, c - d), 1 / share, self.bandwidth, held=True)

    def _has_effort(self, effort: Fraction) -> bool:
        """Tell whether ``Ze D/C`` is nowhere above an effort in the band."""
        if self.environment.law not in (Elastic, KelvinVoigt):
            return False

        def respond(values: Mapping[str, Fraction]) -> tuple[Polynomial, Polynomial]:
            opened, closed = self._cut_loop(values, is_held=True)
            hand = self._contact(values)
            return opened * polynomial(hand.get("b", ZERO), hand["k"]), closed.left_shift(1)

        return self._is_below(respond, effort, self.bandwidth)

    def _stays_below(
        self,
        response: Callable[[Polynomial, Polynomial], tuple[Polynomial, Polynomial]],
        limit: Fraction,
        band: Fraction | None = None,
        *,
        held: bool = False,
    ) -> bool:
        """Tell whether a quotient of D and C is nowhere above a limit, up to a frequency if any."""
        return self._is_below(
            lambda values: response(*self._cut_loop(values, is_held=held)), limit, band
        )

    def _is_below(self, response: Response, limit: Fraction, band: Fraction | None) -> bool:
        pieces = everywhere() if band is None else (FrequencyPiece(ZERO, band**2),)
        return Squares.of(response, self.box).stay_below(limit**2, pieces)

    def _has_phase(self, margin: Fraction) -> bool:
        t, pieces = _tangent(margin / 2), everywhere(Fraction(10))
        return t is not None and self._nowhere_zero(
            Interval(ZERO, -t, t), _squared_magnitude, pieces
        )

    def _has_delay(self, margin: Fraction) -> bool:
        last = self._highest_crossover()
        if last is None:
            return False
        for low, high in pairwise(last * i / _PIECES for i in range(_PIECES + 1)):
            t = _tangent(high * margin / 2)
            if t is None:
                return False
            share, piece = Interval(ZERO, ZERO, t / high), FrequencyPiece(low**2, high**2)
            if not self._nowhere_zero(share, _delayed, (piece,)):
                return False
        return True

    def _nowhere_zero(
        self, share: Interval, square: Square, pieces: Sequence[FrequencyPiece]
    ) -> bool:
        """Tell whether C and a share of ``N - D`` cancel nowhere on the axis."""

        def respond(values: Mapping[str, Fraction]) -> tuple[Polynomial, Polynomial]:
            opened, closed = self._cut_loop(values)
            return closed, rational(values["share"]) * (closed - 2 * opened)

        corners = corners_in(respond, {**self.box, "share": share})
        return Squares(corners, square=square).vanish_nowhere(pieces)

    def _highest_crossover(self) -> Fraction | None:
        """Return a frequency from which on ``|N| < |D|``; None if none is shown."""

        def at(values: Mapping[str, Fraction]) -> tuple[Polynomial, Polynomial]:
            opened, closed = self._cut_loop(values)
            return closed - opened, opened

        proposed = max(_last_crossover(*corner) for corner in corners_in(at, self.box))
        if not proposed:
            return None
        last = Fraction(proposed) * _CLEARANCE
        piece = FrequencyPiece(ZERO, 1 / last**2, inverse=True)
        found = Squares.of(at, self.box).bound(piece, limit=ONE)
        return last if found is not None and found < 1 else None


_PROOFS: dict[Measure, Callable[[RangedLoop, Fraction], bool]] = {
    measures.SENSITIVITY_PEAK: RangedLoop._has_sensitivity,
    measures.GAIN_MARGIN: RangedLoop._stays_stable,
    measures.PHASE_MARGIN: RangedLoop._has_phase,
    measures.DELAY_MARGIN: RangedLoop._has_delay,
    measures.DISK_MARGIN: RangedLoop._has_disk,
    measures.IMPEDANCE_ERROR: RangedLoop._has_impedance,
    measures.TRANSPARENCY: RangedLoop._has_transparency,
    measures.HAND_EFFORT: RangedLoop._has_effort,
}
PROVABLE = tuple(_PROOFS)


def ranged_loops(
    axis: ContinuousAxis,
    law: CompliantLaw,
    environments: Sequence[Environment],
    ranges: Mapping[str, Interval],
) -> tuple[RangedLoop, ...]:
    """Return the loops of a controller in its contacts; none with too many ranges."""
    loops = tuple(RangedLoop(axis, law, environment, ranges) for environment in environments)
    return loops if all(len(loop.box) <= _RANGES for loop in loops) else ()


def add_proofs(
    achieved: Sequence[Achieved],
    loops: Sequence[RangedLoop],
    home: str = "",
    desired: float = 1.0,
    bandwidth: float = 1.0,
) -> tuple[Achieved, ...]:
    """Return worst values with their proofs over the ranges, in about a second.

    The desired impedance is in N m s/rad, the highest frequency of the command in rad/s; `home` is
    the environment that the gains are designed for. They are of impedance controllers alone.
    """
    proposed = [
        found
        for found in achieved
        if found.measure in PROVABLE
        and found.value > 0
        and found.standing is not GoalStanding.MISSED
    ]
    if not proposed or not loops or not all(loop.stable for loop in loops):
        return tuple(achieved)
    contact_loops = [
        replace(loop, desired=Fraction(desired), bandwidth=Fraction(bandwidth))
        for loop in loops
        if loop.environment.name == home
    ]
    return tuple(
        replace(
            found,
            proved=_proved(
                found, contact_loops if found.measure in measures.CONTACT_MEASURES else loops
            ),
        )
        if found in proposed
        else found
        for found in achieved
    )


def _proved(measured: Achieved, loops: Sequence[RangedLoop]) -> Fraction | None:
    """Return the best value that is proved for all loops, of those that are proposed."""
    proved = (
        v for v in _proposed(measured) if all(loop.holds(measured.measure, v) for loop in loops)
    )
    return next(proved, None)


def _proposed(found: Achieved) -> Iterator[Fraction]:
    """Yield values, the best first: the shown one, the goal, and slightly worse ones."""
    goal = found.goal
    # An infinite value at the corners gives no proposal.
    slacks = _SLACK if isfinite(found.value) else ()
    upper, scale = found.measure.upper, found.measure.exact_scale
    context = Context(prec=_DIGITS, rounding=ROUND_CEILING if upper else ROUND_FLOOR)
    for slack in slacks:
        worse = Fraction(found.value) * scale * (1 + slack if upper else 1 - slack)
        displayed = Fraction(context.create_decimal(Decimal(float(worse)))) / scale
        if goal is None or found.measure.violation(float(displayed), goal) <= 0:
            yield displayed
        elif not slack:
            yield Fraction(goal)
    if goal is not None:
        yield Fraction(goal)


def _tangent(angle: Fraction) -> Fraction | None:
    """Return a number that is not below a tangent; None from a quarter of a turn on."""
    if angle > Fraction(3, 2):
        return None
    with precision():
        return fraction_of(ball_around(angle).tan().upper())


def _last_crossover(numerator: Polynomial, denominator: Polynomial) -> float:
    excess = squared_magnitude(numerator) - squared_magnitude(denominator)
    found = frequencies(np.array([[float(c) for c in reversed(excess.coeffs())]]))
    return float(np.nanmax(found, initial=0.0))


def _squared_magnitude(C: Polynomial, E: Polynomial) -> Polynomial:
    """Return ``|C(j omega) + j E(j omega)|^2`` in omega."""
    omega = polynomial(ONE, ZERO)
    (a, b), (c, d) = ([part(omega**2) for part in parts_on_axis(P)] for P in (C, E))
    return (a - omega * d) ** 2 + (omega * b + c) ** 2


def _delayed(C: Polynomial, E: Polynomial) -> Polynomial:
    """Return ``|C(j omega) - j omega E(j omega)|^2`` in omega^2."""
    return squared_magnitude(C - E.left_shift(1))
