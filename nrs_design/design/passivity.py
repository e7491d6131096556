"""Frequencies up to which a displayed admittance is passive, exactly, over the ranges.

The hand applies a torque and meets the admittance ``Y = N/D`` from torque to velocity. D is the
characteristic polynomial of the assembled mode in the air, ``D + b N`` that with a damper b, so
both are exact. Y is passive at omega where ``Re N conj(D) >= 0``, a polynomial in ``x = omega^2``
whose roots are isolated rigorously. With a strictly proper motion loop of relative degree one and
without load, an inertia is not passive at all frequencies (thesis 7): the band counts.

Times the time constant, N and D are affine in Km and tau. Where all Bernstein coefficients of the
polynomial are positive, it is positive in the box. Each parameter is unknown but constant.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from math import isqrt

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.design.affine_family import (
    ONE,
    ZERO,
    Polynomial,
    Response,
    corners_in,
    find_motor,
    polynomial,
    real_product,
    squared_over,
    zeros_at_rest,
)
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.loop.hull import rational
from nrs_design.models.contact import KelvinVoigt
from nrs_design.models.interval import Interval
from nrs_design.proof.enclosure import fraction_of
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable

# How far beyond a root it is looked for a negative value, at first, as a share of the root, and how
# often twice as far.
SHARE, STEPS = Fraction(1, 10**5), 40
DIGITS = 6  # Decimals of a frequency in rad/s

Enclosed = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class PassiveBand:
    """Where a displayed admittance is passive."""

    # Wherever the parameters are in their ranges, it is passive at every frequency up to this one,
    # in rad/s; None for all frequencies, zero where nothing is shown.
    passive: Fraction | None
    # At this one it is not, with parameters at a corner of the ranges: an exact refutation of
    # passivity. None where none was found.
    broken: Fraction | None


def passive_band(
    axis: ContinuousAxis, law: CompliantLaw, ranges: Mapping[str, Interval]
) -> PassiveBand:
    """Find the frequency up to which the displayed admittance is passive, and one where it is not.

    The law has a positive Bt. Ranges are those of ``Km`` and ``tau``, if any.
    """
    if not is_stable(RationalMatrix.from_rows(axis.realization.A), Time.CONTINUOUS):
        return PassiveBand(ZERO, None)
    places = product(range(3), repeat=len(ranges))
    # A zero polynomial is passive, on the border.
    grid = {place: P for place, P in zip(places, real_parts(axis, law, ranges), strict=True) if P}
    if any(P[0] <= 0 for P in grid.values()):
        return PassiveBand(ZERO, None)
    roots = {at: bracket for at, P in grid.items() if (bracket := first_root(P)) is not None}
    broken = (_negative_beyond(grid[at], high) for at, (_, high) in roots.items() if 1 not in at)
    passive = root_below(min(low for low, _ in roots.values())) if roots else None
    return PassiveBand(passive, min((omega for omega in broken if omega), default=None))


def real_parts(
    axis: ContinuousAxis, law: CompliantLaw, ranges: Mapping[str, Interval]
) -> list[Polynomial]:
    """Return ``Re N conj(D)`` in ``x = omega^2``, over what is positive.

    They are the Bernstein coefficients over the box: at its corners, the values there.
    """
    corners = corners_in(impedance_response(axis, law), ranges)
    return [P.right_shift(zeros_at_rest(P)) for P in squared_over(corners, real_product)]


def impedance_response(axis: ContinuousAxis, law: CompliantLaw) -> Response:
    """Return D and N as a function of the parameters."""

    def at(values: Mapping[str, Fraction]) -> tuple[Polynomial, Polynomial]:
        place, factor = find_motor(axis, values)
        free, damped = (
            factor * polynomial(*axis.find_loop(law, KelvinVoigt(ZERO, b), place).closed)
            for b in (ZERO, ONE)
        )
        return free, damped - free

    return at


def first_root(P: Polynomial) -> Enclosed | None:
    """Return bounds on the smallest positive root, or None without one.

    Ball arithmetic isolates all roots rigorously, multiple ones as well. P is not zero at zero.
    """
    real = (root.real for root, _ in P.complex_roots() if root.imag == 0)
    positive = [(fraction_of(root.lower()), fraction_of(root.upper())) for root in real if root > 0]
    return min(positive, default=None)


def _negative_beyond(P: Polynomial, x: Fraction) -> Fraction | None:
    """Return a number whose square is a little beyond x, and where P is negative."""
    step = SHARE * x
    for _ in range(STEPS):
        root = root_below(x + step) + Fraction(1, 10**DIGITS)
        if P(rational(root**2)) < 0:
            return root
        step *= 2
    return None


def root_below(x: Fraction) -> Fraction:
    """Return a number of a few decimals whose square is not above x."""
    return Fraction(isqrt(int(x * 10 ** (2 * DIGITS))), 10**DIGITS)
