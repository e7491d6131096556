"""Numbers in certificate files: integers and ratios of integers, never floats."""

from __future__ import annotations

import re
from collections.abc import Mapping
from decimal import ROUND_DOWN, ROUND_UP, Context, Decimal
from fractions import Fraction
from typing import Any

from nrs_design.certificates.exact import is_too_large
from nrs_design.spec.exact import quoted
from nrs_design.switched.system import Time

Matrix = tuple[tuple[int, ...], ...]


def matrix_fields(Q: Matrix, denominator_log2: int) -> dict[str, Any]:
    """Return the fields of a dyadic matrix."""
    return {"numerators": [list(row) for row in Q], "denominator_log2": denominator_log2}


def read_matrix(fields: Mapping[str, Any]) -> tuple[Matrix, int]:
    """Read a dyadic matrix: its integer numerators, and the logarithm of its denominator."""
    denominator_log2 = read_integer(fields["denominator_log2"])
    if denominator_log2 < 0:
        raise ValueError("a denominator is not a power of two")
    return read_integers(fields["numerators"]), denominator_log2


def read_integers(value: Any) -> Matrix:
    """Read a matrix of integers."""
    matrix = tuple(tuple(read_integer(entry) for entry in row) for row in value)
    if is_too_large(matrix):
        raise ValueError("a matrix is too large to check")
    return matrix


def read_integer(value: object) -> int:
    """Read an integer; a truth value is none."""
    if type(value) is not int:
        raise TypeError(f"expected an integer, not {quoted(str(value))}")
    return value


def read_text(value: object) -> str:
    """Read a text."""
    if not isinstance(value, str):
        raise TypeError(f"expected a text, not {quoted(str(value))}")
    return value


def read_ratio(value: object) -> Fraction:
    """Read a nonnegative ratio of integers, such as 3/8."""
    text = read_text(value)
    if not re.fullmatch(r"[0-9]{1,2000}(/[0-9]{1,2000})?", text):
        raise ValueError(f"{quoted(text)} is not a ratio of integers")
    return Fraction(text)


def rate_text(rate: Fraction, time: Time) -> str:
    """Write a rate with six digits, rounded to its safe side (slower decay)."""
    rounding = ROUND_DOWN if time is Time.CONTINUOUS else ROUND_UP
    context = Context(prec=6, rounding=rounding)
    return str(context.divide(Decimal(rate.numerator), Decimal(rate.denominator)))
