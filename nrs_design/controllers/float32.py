"""Rounding to the single-precision numbers that the robot's controller holds."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

from nrs_design.errors import DesignError

# Bits of the significand, exponent of the smallest step, exponent beyond the largest number.
PRECISION, SMALLEST, LIMIT = 24, -149, 128


def round_float32(value: Fraction) -> Fraction:
    """Round to the nearest single-precision number (ties to even), returned exactly.

    In rationals throughout: by way of a double it would be rounded twice. Beyond the range of
    single precision it is a `DesignError`.
    """
    return _round(value, round)


def _round(value: Fraction, whole: Callable[[Fraction], int]) -> Fraction:
    """Return a neighbor of a value in single precision; `whole` picks which."""
    exponent = value.numerator.bit_length() - value.denominator.bit_length()
    if abs(value) < Fraction(2) ** exponent:
        exponent -= 1
    step = Fraction(2) ** max(exponent + 1 - PRECISION, SMALLEST)
    result = whole(value / step) * step
    if abs(result) >= 1 << LIMIT:
        raise DesignError(
            "a gain is beyond the range of single precision, 3.4e38",
            remedy="choose smaller gains, or other units",
        )
    return result


def float32_not_above(value: Fraction) -> Fraction:
    """Return the largest single-precision number that is not above a value."""
    return _round(value, math.floor)


def float32_not_below(value: Fraction) -> Fraction:
    """Return the smallest single-precision number that is not below a value."""
    return -float32_not_above(-value)


def is_float32(value: Fraction) -> bool:
    """Tell whether a value is a single-precision number."""
    try:
        return round_float32(value) == value
    except DesignError:
        return False


def exact_decimal(value: Fraction) -> str:
    """Return the terminating decimal of a rational whose denominator is a power of two."""
    exponent = value.denominator.bit_length() - 1
    if value.denominator != 1 << exponent:
        raise ValueError(f"{value} has no terminating binary expansion")
    digits = f"{abs(value.numerator) * 5**exponent:0{exponent + 1}d}"
    whole, part = digits[: len(digits) - exponent], digits[len(digits) - exponent :].rstrip("0")
    return ("-" if value < 0 else "") + whole + ("." + part if part else "")


def round_significant(value: float, digits: int) -> Fraction:
    """Round to so many significant decimal digits, returned as the exact decimal."""
    return Fraction(f"{value:.{digits - 1}e}")


def neighbors(value: float, digits: int) -> tuple[float, float, float]:
    """Return a positive value or zero, and values one step of its last significant digit away."""
    if value == 0:
        return (value, value, value)
    step = 10.0 ** (math.floor(math.log10(value)) + 1 - digits)
    return (value - step, value, value + step)
