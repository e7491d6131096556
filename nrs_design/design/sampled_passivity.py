"""Up to which frequency the admittance that a processor displays is passive, exactly.

A hand applies a force F(t). It is sampled, the law makes a command of it, the command is held, and
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

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import floor
from typing import Any

from nrs_design.design.affine_family import (
    ONE,
    ZERO,
    Quotient,
    corners_in,
    is_stable_over,
    lowest_first,
    squared_over,
)
from nrs_design.design.displayed_response import root_below
from nrs_design.design.passivity import evaluate, first_root, highest_first, without_zeros
from nrs_design.design.sampled_response import SampledAdmittance
from nrs_design.loop.cut_loop import multiply

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
