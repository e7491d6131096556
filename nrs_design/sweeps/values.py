"""The values that a field takes: ``1,2,5 N*m/rad`` or ``1..250/16 N*m/rad``, exactly."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from nrs_design.errors import SpecError
from nrs_design.proof.text import exact_text, quoted
from nrs_design.spec import parse_exact
from nrs_design.spec.exact import is_number

EXAMPLE = "write a list such as '1,2,5 N*m/rad', or a range such as '1..250/16 N*m/rad'"
_END = r"[+-]?(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_RANGE = re.compile(rf"({_END})\.\.({_END})(?:/([0-9]{{1,30}}))?(?: +(\S.*))?")
# Where a range has no count, these would be many values by mistake: the ends must be integers.
_WHOLE = "give a count, such as {low}..{high}/16: only whole numbers follow each other without one"


@dataclass(frozen=True, slots=True)
class EvenlySpaced:
    """Values at equal distances, both ends among them; written when one is asked for."""

    low: Fraction
    high: Fraction
    count: int  # At least 2
    unit: str  # Empty for numbers without one

    def __len__(self) -> int:
        """How many there are."""
        return self.count

    def __getitem__(self, index: int) -> str:
        """Return a value as a spec writes it: a decimal where that is exact, else a ratio."""
        value = self.low + (self.high - self.low) * Fraction(index, self.count - 1)
        return _with_unit(exact_text(value), self.unit)


Values: TypeAlias = EvenlySpaced | tuple[str, ...]


def parse_values(text: str) -> Values:
    """Read the values of one field: a list with commas, or a range.

    The last unit is that of all that have none. A range is ``LOW..HIGH/COUNT UNIT``, or ``LOW..HIGH
    UNIT`` for the whole numbers from LOW to HIGH.
    """
    text = text.strip()
    if found := _RANGE.fullmatch(text):
        return _spaced(*found.groups())
    if ".." in text:
        raise SpecError(f"{quoted(text)} is not a range", remedy=EXAMPLE)
    return _listed(text)


def _spaced(
    low_text: str, high_text: str, count_text: str | None, unit: str | None
) -> EvenlySpaced:
    low, high = parse_exact(low_text), parse_exact(high_text)
    said = quoted(f"{low_text}..{high_text}")
    if low > high:
        remedy = f"write {high_text}..{low_text}"
        raise SpecError(f"the range {said} is reversed", remedy=remedy)
    if low == high:
        raise SpecError(f"the range {said} is empty", remedy=f"write {low_text} alone")
    if count_text is not None:
        count = int(count_text)
    elif low.denominator == high.denominator == 1:
        count = int(high - low) + 1
    else:
        remedy = _WHOLE.format(low=low_text, high=high_text)
        raise SpecError(f"the range {said} has no count", remedy=remedy)
    if count < 2:
        raise SpecError(
            f"a range has two ends, and {said} is to have {count} of them",
            remedy="give a count of 2 or more, or a list of values",
        )
    if count > sys.maxsize:
        raise SpecError(
            f"{said} has more values than a sequence may have",
            remedy="give a smaller count, such as 1..250/16",
        )
    return EvenlySpaced(low, high, count, unit or "")


def _listed(text: str) -> tuple[str, ...]:
    items = [item.strip() for item in text.split(",")]
    if not all(items):
        raise SpecError(f"{quoted(text)} lacks a value", remedy=EXAMPLE)
    if any(mark in text for mark in "[]{}"):
        raise SpecError(
            f"{quoted(text)} holds a list or a mapping",
            remedy="name the single field below it, such as environments.soft.stiffness.nominal",
        )
    unit = items[-1].partition(" ")[2].strip()
    values = tuple(_with_unit(item, unit) if is_number(item) else item for item in items)
    if twice := next((value for at, value in enumerate(values) if value in values[:at]), None):
        raise SpecError(f"the value {quoted(twice)} is there twice", remedy="leave one out")
    return values


def _with_unit(number: str, unit: str) -> str:
    return f"{number} {unit}" if unit else number
