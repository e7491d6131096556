"""Up to which frequency a displayed admittance is passive, exactly.

A surgeon who holds the tool meets the admittance ``G Y`` with ``Y = 1/(Mt s + Bt)``. It is passive
at omega where ``Re 1/(G Y) >= 0``; times the square of the numerator of G, that is a polynomial in
``x = omega^2`` with rational coefficients. Its sign is decided by Sturm's theorem, without a grid.
With a strictly proper G of relative degree one the displayed admittance has relative degree two, so
with an inertia it is never passive at all frequencies (thesis 7): what counts is the band.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import gcd, isqrt, lcm

from nrs_design.models.motion_loop import MotionLoop

# Frequencies are bracketed to this share, in rad/s.
RESOLUTION = Fraction(1, 10**5)
# How often the point beyond the first root is halved towards it.
HALVINGS = 40

Polynomial = list[Fraction]


@dataclass(frozen=True)
class PassiveBand:
    """Where a displayed admittance is passive.

    Parameters
    ----------
    passive : Fraction or None
        It is passive at every frequency up to this one, in rad/s; None for all frequencies.
    broken : Fraction or None
        At this one it is not: an exact refutation of passivity. None where none was found.
    """

    passive: Fraction | None
    broken: Fraction | None


def passive_band(loop: MotionLoop, Mt: Fraction, Bt: Fraction) -> PassiveBand:
    """Find the frequency up to which ``G Y`` is passive, and one at which it is not.

    Parameters
    ----------
    loop : MotionLoop
        Closed motion loop G, stable.
    Mt : Fraction
        Virtual inertia in kg m^2, not negative.
    Bt : Fraction
        Virtual damping in N m s/rad, positive.
    """
    P = real_part(loop, Mt, Bt)
    if P[-1] <= 0:
        return PassiveBand(Fraction(0), None)
    bracket = first_root(P)
    if bracket is None:
        return PassiveBand(None, None)
    low, high = bracket
    broken = _negative_beyond(P, high)
    return PassiveBand(root_below(low), broken)


def first_root(P: Sequence[Fraction]) -> tuple[Fraction, Fraction] | None:
    """Return numbers between which the smallest positive root is, or None if there is none.

    There is no root up to the first one, and the second is `RESOLUTION` above it at most.

    Parameters
    ----------
    P : sequence of Fraction
        Coefficients, highest power first; neither the first nor the last is zero.
    """
    chain = _simple_chain(P)
    none, high = _changes(chain, Fraction(0)), 1 + max(map(abs, P)) / abs(P[0])
    if none == _changes(chain, high):
        return None
    low = Fraction(0)
    while high - low > RESOLUTION * high:
        middle = _rounded((low + high) / 2)
        low, high = (low, middle) if none > _changes(chain, middle) else (middle, high)
    return low, high


def real_part(loop: MotionLoop, Mt: Fraction, Bt: Fraction) -> Polynomial:
    """Return ``Re 1/(G Y)`` times the squared numerator of G, in ``x = omega^2``.

    Parameters
    ----------
    loop, Mt, Bt
        As for `passive_band`.

    Returns
    -------
    list of Fraction
        Coefficients, highest power first, the leading one not zero.
    """
    mirrored = [c * (-1) ** k for k, c in enumerate(reversed(loop.numerator))][::-1]
    product = _times(_times([Mt, Bt], list(loop.denominator)), mirrored)
    even = list(reversed(product))[::2]
    terms = [c * (-1) ** k for k, c in enumerate(even)][::-1]
    while len(terms) > 1 and terms[0] == 0:
        terms.pop(0)
    return terms


def count_positive_roots(P: Sequence[Fraction], end: Fraction) -> int:
    """Count the different roots in (0, end] by Sturm's theorem.

    Parameters
    ----------
    P : sequence of Fraction
        Coefficients, highest power first; not zero at 0.
    end : Fraction
        Positive.
    """
    chain = _simple_chain(P)
    return _changes(chain, Fraction(0)) - _changes(chain, end)


def _simple_chain(P: Sequence[Fraction]) -> list[Polynomial]:
    """Return the chain of a polynomial, or of one that has the same roots, each of them once."""
    chain = _sturm_chain(list(P))
    if len(chain[-1]) > 1:
        # Roots that are multiple ones are those of the last element: without it, each is single.
        chain = _sturm_chain(_divided(P, chain[-1])[0])
    return chain


def _sturm_chain(P: Polynomial) -> list[Polynomial]:
    """Return P, its derivative and the negative remainders; the last is a common divisor.

    Positive factors change no sign, so each has integers without a common divisor.
    """
    chain = [_primitive(P), _primitive(_derivative(P))]
    if not any(chain[1]):
        return chain[:1]
    while any(rest := [-c for c in _divided(chain[-2], chain[-1])[1]]):
        chain.append(_primitive(rest))
    return chain


def _primitive(P: Sequence[Fraction]) -> Polynomial:
    """Divide a polynomial by a positive number, so that its coefficients are short integers."""
    common = lcm(*(c.denominator for c in P))
    numerators = [int(c * common) for c in P]
    divisor = gcd(*numerators) or 1
    return [Fraction(n // divisor) for n in numerators]


def _changes(chain: Sequence[Polynomial], x: Fraction) -> int:
    signs = [value > 0 for value in (_sign(P, x) for P in chain) if value]
    return sum(a != b for a, b in pairwise(signs))


def _sign(P: Polynomial, x: Fraction) -> int:
    """Return the value of a polynomial with integers, times a positive number."""
    value, power = 0, 1
    for c in P:
        value = value * x.numerator + c.numerator * power
        power *= x.denominator
    return value


def evaluate(P: Sequence[Fraction], x: Fraction) -> Fraction:
    """Return the value of a polynomial, its coefficients with the highest power first."""
    value = Fraction(0)
    for c in P:
        value = value * x + c
    return value


def _derivative(P: Sequence[Fraction]) -> Polynomial:
    n = len(P) - 1
    return [c * (n - k) for k, c in enumerate(P[:-1])] or [Fraction(0)]


def _divided(P: Sequence[Fraction], Q: Sequence[Fraction]) -> tuple[Polynomial, Polynomial]:
    """Return quotient and remainder."""
    quotient, rest = [], list(P)
    while len(rest) >= len(Q):
        factor = rest[0] / Q[0]
        quotient.append(factor)
        for k, entry in enumerate(Q):
            rest[k] -= factor * entry
        rest.pop(0)
    while len(rest) > 1 and rest[0] == 0:
        rest.pop(0)
    return quotient, rest or [Fraction(0)]


def _times(P: Sequence[Fraction], Q: Sequence[Fraction]) -> Polynomial:
    product = [Fraction(0)] * (len(P) + len(Q) - 1)
    for i, a in enumerate(P):
        for j, b in enumerate(Q):
            product[i + j] += a * b
    return product


def _rounded(x: Fraction) -> Fraction:
    """Keep few digits, at which the sign is decided just as well."""
    return x.limit_denominator(10**9) if x > Fraction(1, 1000) else x


def root_below(x: Fraction, digits: int = 6) -> Fraction:
    """Return a number of so many decimals whose square is not above x."""
    return Fraction(isqrt(int(x * 10 ** (2 * digits))), 10**digits)


def _negative_beyond(P: Sequence[Fraction], x: Fraction) -> Fraction | None:
    """Return a frequency a little beyond a root in x at which the real part is negative."""
    step = RESOLUTION * x
    for _ in range(HALVINGS):
        omega = root_below(x + step) + Fraction(1, 10**6)
        if evaluate(P, omega**2) < 0:
            return omega
        step *= 2
    return None
