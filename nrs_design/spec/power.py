"""Powers with rational exponents, between two decimals, in integers alone."""

from __future__ import annotations

from fractions import Fraction
from math import floor, log10

# Digits of the bounds, at least.
DIGITS = 10


def power_between(base: Fraction, exponent: Fraction) -> tuple[Fraction, Fraction]:
    """Return decimals at most and at least ``base^exponent``, and nearly equal.

    With ``exponent = p/q`` and a unit u, ``r u`` is the lower one for the largest r with
    ``(r u)^q <= base^p``, and ``(r + 1) u`` the upper one, unless the lower one is the power. The
    base is positive, else a ValueError; numbers have as many digits as q is large.
    """
    # To load it takes longer than to read a spec, and few have such powers.
    from flint import fmpz

    if base <= 0:
        raise ValueError(f"{base} has no power with a rational exponent")
    q, power = exponent.denominator, base**exponent.numerator
    # How large the power is, is asked of a float; it decides how near the bounds are, no more.
    size = float(exponent) * (log10(base.numerator) - log10(base.denominator))
    unit = Fraction(10) ** (floor(size) - DIGITS)
    scaled = power / unit**q
    lower = int(fmpz(floor(scaled)).root(q))
    upper = lower if lower**q == scaled else lower + 1
    return lower * unit, upper * unit
