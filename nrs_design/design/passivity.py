"""Up to which frequency a displayed admittance is passive, exactly, over the ranges.

A surgeon who holds the tool applies a torque and meets the admittance ``Y = N/D`` from it to the
velocity of the tool: what the law makes of the torque, and what the torque itself turns of a motor
with a load. D is the characteristic polynomial of the assembled mode that touches nothing, and
``D + b N`` that with a damper b, so both are exact. Y is passive at omega where
``Re N conj(D) >= 0``, a polynomial in ``x = omega^2`` with rational coefficients. Its roots are
isolated rigorously, without a grid. With a strictly proper motion loop of relative degree
one and no load, Y has relative degree two with an inertia, so it is never passive at all
frequencies (thesis 7): what counts is the band.

Ranges: times Mt (or Bt without inertia) and the time constant, N and D are affine in each of Km,
tau, Mt, Bt and Kt, so the polynomial is of second degree at most in each. Anywhere in the box it is
a mean of its Bernstein coefficients: where all of these are positive, so is it. Each parameter is
unknown but constant; that is what a frequency is about.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import product
from math import floor, lcm
from typing import Any

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.design.affine_family import (
    ONE,
    ZERO,
    Quotient,
    corners_in,
    is_stable_over,
    lowest_first,
    real_product,
    squared_over,
)
from nrs_design.design.displayed_response import impedance_at, root_below
from nrs_design.design.sampled_response import SampledAdmittance
from nrs_design.loop.cut_loop import ContinuousAxis, multiply
from nrs_design.models.interval import Interval
from nrs_design.proof.enclosure import fraction_of
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable

# How far beyond a root it is looked for a negative value, at first, as a share of the root.
RESOLUTION = Fraction(1, 10**5)
# How often the point beyond the first root is halved towards it.
HALVINGS = 40

Polynomial = list[Fraction]


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

    The law has a positive Bt. Ranges are those of ``Mt``, ``Bt``, ``Kt``, ``Km``, ``tau``, if any.
    """
    if not is_stable(RationalMatrix.from_rows(axis.realization.A), Time.CONTINUOUS):
        return PassiveBand(Fraction(0), None)
    places = product(range(3), repeat=len(ranges))
    grid = dict(zip(places, real_parts(axis, law, ranges), strict=True))
    # None is zero at every frequency: passive, and on the border of it.
    bounds = [P for Q in grid.values() if any(P := without_zeros(Q))]
    if any(P[-1] <= 0 for P in bounds):
        return PassiveBand(Fraction(0), None)
    roots = [bracket for P in bounds if (bracket := first_root(P)) is not None]
    corners = [P for at, Q in grid.items() if 1 not in at and any(P := without_zeros(Q))]
    found = [(bracket[1], P) for P in corners if (bracket := first_root(P)) is not None]
    broken = [omega for high, P in found if (omega := _negative_beyond(P, high)) is not None]
    passive = root_below(min(low for low, _ in roots)) if roots else None
    return PassiveBand(passive, min(broken, default=None))


def real_parts(
    axis: ContinuousAxis, law: CompliantLaw, ranges: Mapping[str, Interval]
) -> list[Polynomial]:
    """Return ``Re N conj(D)`` in ``x = omega^2``, times what is positive, highest power first.

    They are the Bernstein coefficients over the box: at its corners, the values there.
    """
    corners = corners_in(impedance_at(axis, law), ranges)
    both = [[*lowest_first(found.above), *lowest_first(found.below)] for found in corners]

    def real(both: Sequence[Any]) -> list[Any]:
        n = len(both) // 2
        return real_product(both[:n], both[n:])

    return [*map(highest_first, squared_over(both, real))]


def highest_first(P: Sequence[Any]) -> Polynomial:
    """Return a polynomial of Flint, lowest power first, the other way round."""
    return [Fraction(int(c.p), int(c.q)) for c in reversed(P)]


def without_zeros(P: Polynomial) -> Polynomial:
    """Leave out zeros of the highest powers, and powers of x that all terms have."""
    kept = [i for i, c in enumerate(P) if c]
    return P[kept[0] : kept[-1] + 1] if kept else []


def first_root(P: Sequence[Fraction]) -> tuple[Fraction, Fraction] | None:
    """Return numbers between which the smallest positive root is, or None if there is none.

    Ball arithmetic isolates all roots rigorously, multiple ones as well. Coefficients are given
    with the highest power first; neither the first nor the last is zero.
    """
    from flint import fmpz_poly

    common = lcm(*(c.denominator for c in P))
    # The stubs of python-flint leave out the multiplicities.
    roots: Any = fmpz_poly([int(c * common) for c in reversed(P)]).complex_roots()
    real = (root.real for root, _ in roots if root.imag == 0)
    positive = [(fraction_of(root.lower()), fraction_of(root.upper())) for root in real if root > 0]
    return min(positive, default=None)


def evaluate(P: Sequence[Fraction], x: Fraction) -> Fraction:
    """Return the value of a polynomial, its coefficients with the highest power first."""
    value = Fraction(0)
    for c in P:
        value = value * x + c
    return value


def _negative_beyond(P: Sequence[Fraction], x: Fraction) -> Fraction | None:
    """Return a frequency a little beyond a root in x at which the real part is negative."""
    step = RESOLUTION * x
    for _ in range(HALVINGS):
        omega = root_below(x + step) + Fraction(1, 10**6)
        if evaluate(P, omega**2) < 0:
            return omega
        step *= 2
    return None


# Convergents of the continued fraction of the arctangent: the last one, and the one before.
DEPTH = 6
# How often the point beyond the first root is moved on, at first by this share.
STEPS, SHARE = 30, Fraction(1, 10**5)

Enclosed = tuple[Fraction, Fraction]


@dataclass(frozen=True)
class SampledBand:
    """Where the admittance that a processor displays is passive."""

    age: int  # Of the force sample, always the same, in samples
    # It is passive at every frequency up to this one, in rad/s; zero where that is not shown.
    passive: Fraction
    # Between these frequencies in rad/s is one at which it is not; None where none was found.
    broken: Enclosed | None = None
    tangent: Fraction | None = None  # The ``tan(omega T/2)`` of that frequency omega, exactly


def sampled_bands(shown: SampledAdmittance, ages: Iterable[int]) -> tuple[SampledBand, ...]:
    """Find where the displayed admittance is passive, for every age of the force in samples.

    The motor has no ranges. Empty where the law that nobody holds is not shown to be stable: a
    displayed admittance then says nothing.
    """
    if not is_stable_over(shown.quotient, shown.box):
        return ()
    return tuple(_band(shown, age) for age in ages)


def _band(shown: SampledAdmittance, age: int) -> SampledBand:
    """Bracket the first frequency at which the real part may be negative."""
    signs, period = [*_signs(shown, age)], shown.period
    if min(P[-1] for P in signs) <= 0:
        return SampledBand(age, ZERO)
    brackets = [bracket for P in signs if (bracket := first_root(without_zeros(P))) is not None]
    if not brackets:
        # Up to half the sampling rate; pi is more than 3.14159.
        return SampledBand(age, Fraction(314159, 100_000) / period)
    low, high = min(brackets)
    passive, _ = _frequency(root_below(low, 18), period)
    step = SHARE * high
    for _ in range(STEPS):
        t = root_below(high + step, 12) + Fraction(1, 10**12)
        if all(evaluate(P, t**2) < 0 for P in signs):
            return SampledBand(age, passive, _frequency(t, period), t)
        step *= 2
    return SampledBand(age, passive)


def _signs(shown: SampledAdmittance, age: int) -> Iterable[list[Fraction]]:
    """Yield polynomials in x, highest power first, of which what has the sign of Re V is a mean.

    Where all are positive, so is Re V; where all are negative, it is negative.
    """
    late, early = [ONE], [ONE]
    for _ in range(age):
        late, early = multiply(late, [-ONE, ONE]), multiply(early, [ONE, ONE])

    def older(values: Any) -> Quotient:
        command, poles = shown.command(values)
        return Quotient(multiply(late, command), multiply(early, poles), ())

    corners = corners_in(older, shown.box)
    both = [[*lowest_first(found.above), *lowest_first(found.below)] for found in corners]
    lag = 2 * shown.motor.time_constant.nominal / shown.period
    for depth in (DEPTH, DEPTH + 1):
        yield from map(highest_first, squared_over(both, partial(_sign, lag=lag, depth=depth)))


def _sign(both: Sequence[Any], lag: Fraction, depth: int) -> list[Any]:
    """Return the sign polynomial of N and D, one after the other; the lag is ``2 tau/T``."""
    from flint import fmpq, fmpq_poly

    n = len(both) // 2
    N, mirrored = fmpq_poly(both[:n]), fmpq_poly([c * (-1) ** k for k, c in enumerate(both[n:])])
    W = (fmpq_poly([1, -1]) * N * mirrored).coeffs()
    real, imaginary = (
        fmpq_poly([c * (-1) ** k for k, c in enumerate(W[first::2])]) for first in (0, 1)
    )
    p, q = _arctangent(depth)
    late = fmpq_poly([0, fmpq(lag.numerator, lag.denominator)]) * imaginary
    found: list[Any] = (q * real + p * late).coeffs()
    # Of one length, whichever powers cancel.
    return [*found, *[fmpq(0)] * (2 * n + depth - len(found))]


def _arctangent(depth: int) -> tuple[Any, Any]:
    """Return a convergent p/q of ``atan(t)/t`` as polynomials in x, q positive for positive x.

    ``atan(t)/t = 1/(1 + x/(3 + 4x/(5 + 9x/(7 + ...))))``. All terms are positive, so the
    convergents are in turn above and below.
    """
    from flint import fmpq_poly

    p, q = fmpq_poly([1]), fmpq_poly([2 * depth + 1])
    for k in range(depth, 0, -1):
        # 2k - 1 + k^2 x/(q/p)
        p, q = q, (2 * k - 1) * q + fmpq_poly([0, k * k]) * p
    return p, q


def _frequency(t: Fraction, period: Fraction) -> Enclosed:
    """Enclose ``2 atan(t)/T`` between decimals."""
    found = []
    for depth in (DEPTH, DEPTH + 1):
        p, q = (evaluate(highest_first(P.coeffs()), t**2) for P in _arctangent(depth))
        found.append(2 * t * p / q / period)
    unit = 10**9
    return Fraction(floor(min(found) * unit), unit), Fraction(-floor(-max(found) * unit), unit)
