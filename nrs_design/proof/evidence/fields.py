"""Numbers in certificate files: integers and ratios of integers, never floats."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from fractions import Fraction
from typing import Any

from nrs_design.proof.bounds import at_least, at_most, lower, upper
from nrs_design.proof.exact import is_too_large
from nrs_design.proof.mode import Time
from nrs_design.proof.text import quoted

Matrix = tuple[tuple[int, ...], ...]

# Python reads and writes integers of at most 4300 decimal digits, `read_ratio` of at most 2000.
MAX_INTEGER_BITS = 14_000
MAX_RATIO_BITS = 6_640
MAX_ENTRIES = 100_000


def matrix_fields(Q: Matrix, denominator_log2: int) -> dict[str, Any]:
    """Return the fields of a dyadic matrix."""
    return {"numerators": [list(row) for row in Q], "denominator_log2": denominator_log2}


def read_dyadic(fields: Mapping[str, Any]) -> tuple[Matrix, int]:
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


def rounding_fields(roundings: tuple[int, ...]) -> dict[str, Any]:
    """Return the field of the multipliers for what the arithmetic rounds, if there are any."""
    return {"roundings": list(roundings)} if roundings else {}


def read_roundings(fields: Mapping[str, Any]) -> tuple[int, ...]:
    """Read the multipliers for what the arithmetic rounds; none where there is no such field."""
    return tuple(read_integer(entry) for entry in fields.get("roundings", []))


def read_integer(value: object) -> int:
    """Read an integer; a truth value is not one."""
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


def find_unreadable(value: object) -> str | None:
    """TRUSTED: say why a certificate file could not hold the numbers of evidence, or None.

    An integer of NumPy overflows without a word, so it is refused as floats are.
    """
    if value is None or isinstance(value, str):
        return None
    if isinstance(value, Fraction):
        return _find_long((value.numerator, value.denominator), MAX_RATIO_BITS)
    if isinstance(value, tuple | list):
        parts = tuple(value)
        if len(parts) > MAX_ENTRIES:
            return f"a list has {len(parts)} entries, more than {MAX_ENTRIES} are not read"
    elif is_dataclass(value):
        parts = tuple(getattr(value, field.name) for field in fields(value))
    else:
        return _find_long((value,), MAX_INTEGER_BITS)
    return next((fault for part in parts if (fault := find_unreadable(part)) is not None), None)


def _find_long(numbers: tuple[object, ...], bits: int) -> str | None:
    for number in numbers:
        if type(number) is not int:
            return f"a number is of type {type(number).__name__}, not an exact integer"
        if number.bit_length() > bits:
            return f"a number has {number.bit_length()} bits, more than {bits} are not read"
    return None


def rate_text(rate: Fraction, time: Time) -> str:
    """Write a rate: exactly if that is short, else rounded to its safe side (slower decay)."""
    return lower(rate) if time is Time.CONTINUOUS else upper(rate)


def rate_words(rate: Fraction, time: Time) -> str:
    """Write which rate is shown, such as ``alpha = 0.5 1/s``, ``>=`` and ``<=`` where rounded."""
    if time is Time.CONTINUOUS:
        return f"alpha {at_least(rate, '1/s')}"
    return f"rho {at_most(rate)}"
