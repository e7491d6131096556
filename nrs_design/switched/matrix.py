"""Rational matrices: integers over one common denominator."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, lcm

Rows = Sequence[Sequence[Fraction | int]]


@dataclass(frozen=True, slots=True)
class RationalMatrix:
    """An exact matrix ``numerators / denominator``.

    One denominator for all entries keeps the exact checks in integer arithmetic: a positive
    factor changes neither definiteness nor the Hurwitz property.

    Parameters
    ----------
    numerators : tuple of tuple of int
        The rows.
    denominator : int
        Positive.
    """

    numerators: tuple[tuple[int, ...], ...]
    denominator: int = 1

    @classmethod
    def from_rows(cls, rows: Rows) -> RationalMatrix:
        """Bring rational rows over their least common denominator."""
        fractions = [[Fraction(entry) for entry in row] for row in rows]
        denominator = lcm(*(entry.denominator for row in fractions for entry in row))
        numerators = tuple(
            tuple(entry.numerator * (denominator // entry.denominator) for entry in row)
            for row in fractions
        )
        return cls(numerators, denominator)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.numerators), len(self.numerators[0])

    def fractions(self) -> list[list[Fraction]]:
        """Return the entries as reduced fractions."""
        return [[Fraction(entry, self.denominator) for entry in row] for row in self.numerators]

    def floats(self) -> list[list[float]]:
        """Return the entries, each rounded once to the nearest double (infinite beyond them)."""
        return [[_to_float(entry, self.denominator) for entry in row] for row in self.numerators]


def multiply(left: Rows, right: Rows) -> list[list[Fraction]]:
    """Return the exact matrix product ``left @ right``."""
    columns = list(zip(*right, strict=True))
    return [[_dot(row, column) for column in columns] for row in left]


def _to_float(numerator: int, denominator: int) -> float:
    try:
        return numerator / denominator
    except OverflowError:
        return inf if numerator > 0 else -inf


def _dot(left: Iterable[Fraction | int], right: Iterable[Fraction | int]) -> Fraction:
    return sum((Fraction(a) * b for a, b in zip(left, right, strict=True)), Fraction(0))
