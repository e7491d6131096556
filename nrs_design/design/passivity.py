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

Of the admittance that a processor displays, the same is found for each age of the force sample. A
hand applies a force F(t). It is sampled, the law makes a command of it, the command is held, and
the motor turns. Of a force with the frequency omega, below half the sampling rate, the velocity of
the tool has a part of the same frequency, and others beyond half the rate which take no power from
that force. With ``z = exp(j omega T)`` and the law's transfer function U from force to command, the
part is

    V = Km/(tau j omega + 1)  (1 - 1/z)/(j omega T)  U(z).

Where ``Re V > 0`` for all frequencies up to one, no force of finite energy and none but these
frequencies takes energy from the robot (Parseval). Where ``Re V < 0``, a sinusoid does. Nothing is
claimed of other forces: one that is zero at the samples and acts in between may take any amount, so
no law that samples a force is passive for all of them. Where a virtual wall is displayed instead,
the position is sampled, and Colgate and Schenkel (1997) have the condition.

With ``z = (1 + w)/(1 - w)`` and ``w = j t``, ``t = tan(omega T/2)``, the sign of Re V is that of

    Re W(j t) + tau omega Im W(j t),    W(w) = (1 - w) N(w) D(-w),    U = N/D,

which is a polynomial in ``x = t^2``, but for ``omega t = (2/T) x h`` with ``h = atan(t)/t``. It is
affine in h, so its sign is shown for a number below h and one above: convergents of Gauss's
continued fraction of atan. N and D are those of `nrs_design.design.sampled_response`, affine in
each of two enclosed numbers of the motor: so the polynomial is a mean of its Bernstein coefficients
over their box, whose roots are isolated rigorously.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import product
from math import floor
from typing import TYPE_CHECKING, Any

from nrs_design.controllers.laws import CompliantLaw
from nrs_design.design.affine_family import (
    ONE,
    ZERO,
    Polynomial,
    Quotient,
    as_fmpq,
    corners_in,
    is_stable_over,
    parts_on_axis,
    polynomial,
    real_product,
    squared_over,
    zeros_at_rest,
)
from nrs_design.design.displayed_response import impedance_at, root_below
from nrs_design.loop.cut_loop import ContinuousAxis
from nrs_design.models.interval import Interval
from nrs_design.proof.enclosure import fraction_of
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable

if TYPE_CHECKING:
    from nrs_design.design.sampled_response import SampledAdmittance

# How far beyond a root it is looked for a negative value, at first, as a share of the root, and how
# often twice as far.
SHARE, STEPS = Fraction(1, 10**5), 40
# Convergents of the continued fraction of the arctangent: the last one, and the one before.
DEPTH = 6

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

    The law has a positive Bt. Ranges are those of ``Mt``, ``Bt``, ``Kt``, ``Km``, ``tau``, if any.
    """
    if not is_stable(RationalMatrix.from_rows(axis.realization.A), Time.CONTINUOUS):
        return PassiveBand(ZERO, None)
    places = product(range(3), repeat=len(ranges))
    # None is zero at every frequency: passive, and on the border of it.
    grid = {at: P for at, P in zip(places, real_parts(axis, law, ranges), strict=True) if P}
    if any(P[0] <= 0 for P in grid.values()):
        return PassiveBand(ZERO, None)
    roots = {at: bracket for at, P in grid.items() if (bracket := first_root(P)) is not None}
    broken = (
        _negative_beyond((grid[at],), high, 6) for at, (_, high) in roots.items() if 1 not in at
    )
    passive = root_below(min(low for low, _ in roots.values())) if roots else None
    return PassiveBand(passive, min((omega for omega in broken if omega), default=None))


def real_parts(
    axis: ContinuousAxis, law: CompliantLaw, ranges: Mapping[str, Interval]
) -> list[Polynomial]:
    """Return ``Re N conj(D)`` in ``x = omega^2``, over what is positive.

    They are the Bernstein coefficients over the box: at its corners, the values there.
    """
    corners = [corner[:2] for corner in corners_in(impedance_at(axis, law), ranges)]
    return [without_zeros(P) for P in squared_over(corners, real_product)]


def without_zeros(P: Polynomial) -> Polynomial:
    """Leave out powers of x that all terms have."""
    return P.right_shift(zeros_at_rest(P))


def first_root(P: Polynomial) -> Enclosed | None:
    """Return numbers between which the smallest positive root is, or None if there is none.

    Ball arithmetic isolates all roots rigorously, multiple ones as well. P is not zero at zero.
    """
    real = (root.real for root, _ in P.complex_roots() if root.imag == 0)
    positive = [(fraction_of(root.lower()), fraction_of(root.upper())) for root in real if root > 0]
    return min(positive, default=None)


def _negative_beyond(
    polynomials: Iterable[Polynomial], x: Fraction, digits: int
) -> Fraction | None:
    """Return a number of so many digits, its square a little beyond x, where all are negative."""
    step = SHARE * x
    for _ in range(STEPS):
        root = root_below(x + step, digits) + Fraction(1, 10**digits)
        if all(P(as_fmpq(root**2)) < 0 for P in polynomials):
            return root
        step *= 2
    return None


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
    if min(P[0] for P in signs) <= 0:
        return SampledBand(age, ZERO)
    brackets = [bracket for P in signs if (bracket := first_root(without_zeros(P))) is not None]
    if not brackets:
        # Up to half the sampling rate; pi is more than 3.14159.
        return SampledBand(age, Fraction(314159, 100_000) / period)
    low, high = min(brackets)
    passive, _ = _frequency(root_below(low, 18), period)
    t = _negative_beyond(signs, high, 12)
    return SampledBand(age, passive, None if t is None else _frequency(t, period), t)


def _signs(shown: SampledAdmittance, age: int) -> Iterator[Polynomial]:
    """Yield polynomials in x of which what has the sign of Re V is a mean.

    Where all are positive, so is Re V; where all are negative, it is negative.
    """

    def older(values: Any) -> Quotient:
        command, poles = shown.command(values)
        return Quotient(polynomial(-ONE, ONE) ** age * command, polynomial(ONE, ONE) ** age * poles)

    corners = [corner[:2] for corner in corners_in(older, shown.box)]
    lag = polynomial(2 * shown.motor.time_constant.nominal / shown.period, ZERO)
    for depth in (DEPTH, DEPTH + 1):
        yield from squared_over(corners, partial(_sign, lag=lag, depth=depth))


def _sign(N: Polynomial, D: Polynomial, lag: Polynomial, depth: int) -> Polynomial:
    """Return the sign polynomial; the lag is ``2 tau/T x``."""
    real, imaginary = parts_on_axis(polynomial(-ONE, ONE) * N * D(polynomial(-ONE, ZERO)))
    p, q = _arctangent(depth)
    return q * real + p * lag * imaginary


def _arctangent(depth: int) -> tuple[Polynomial, Polynomial]:
    """Return a convergent p/q of ``atan(t)/t`` as polynomials in x, q positive for positive x.

    ``atan(t)/t = 1/(1 + x/(3 + 4x/(5 + 9x/(7 + ...))))``. All terms are positive, so the
    convergents are in turn above and below.
    """
    p, q = polynomial(ONE), polynomial(Fraction(2 * depth + 1))
    for k in range(depth, 0, -1):
        # 2k - 1 + k^2 x/(q/p)
        p, q = q, (2 * k - 1) * q + (k * k * p).left_shift(1)
    return p, q


def _frequency(t: Fraction, period: Fraction) -> Enclosed:
    """Enclose ``2 atan(t)/T`` between decimals."""
    found = []
    for depth in (DEPTH, DEPTH + 1):
        p, q = (P(as_fmpq(t**2)) for P in _arctangent(depth))
        ratio = p / q
        found.append(2 * t * Fraction(int(ratio.p), int(ratio.q)) / period)
    unit = 10**9
    return Fraction(floor(min(found) * unit), unit), Fraction(-floor(-max(found) * unit), unit)
