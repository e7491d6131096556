"""Rounding to the single-precision numbers that the robot's controller holds."""

from __future__ import annotations

import struct
from fractions import Fraction


def to_float32(value: Fraction) -> Fraction:
    """Round to the nearest single-precision number, returned exactly.

    Raises
    ------
    OverflowError
        If the value is beyond the range of single precision.
    """
    rounded: float = struct.unpack("<f", struct.pack("<f", float(value)))[0]
    return Fraction(rounded)


def is_float32(value: Fraction) -> bool:
    """Tell whether a value is a single-precision number."""
    try:
        return to_float32(value) == value
    except OverflowError:
        return False


def exact_decimal(value: Fraction) -> str:
    """Return the terminating decimal of a dyadic rational.

    Raises
    ------
    ValueError
        If the denominator is not a power of two.
    """
    exponent = value.denominator.bit_length() - 1
    if value.denominator != 1 << exponent:
        raise ValueError(f"{value} has no terminating binary expansion")
    digits = f"{abs(value.numerator) * 5**exponent:0{exponent + 1}d}"
    whole, part = digits[: len(digits) - exponent], digits[len(digits) - exponent :].rstrip("0")
    return ("-" if value < 0 else "") + whole + ("." + part if part else "")


def round_significant(value: float, digits: int) -> Fraction:
    """Round to so many significant decimal digits, returned as the exact decimal."""
    return Fraction(f"{value:.{digits - 1}e}")
