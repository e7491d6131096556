"""Rational matrices: integers over one common denominator."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf, lcm
from operator import index
from typing import TypeVar

Rows = Sequence[Sequence[Fraction | int]]
Entry = TypeVar("Entry", int, Fraction)


@dataclass(frozen=True, slots=True)
class RationalMatrix:
    """An exact matrix ``numerators / denominator``.

    One denominator for all entries keeps the exact checks in integer arithmetic: a positive
    factor changes neither definiteness nor the Hurwitz property.
    """

    numerators: tuple[tuple[int, ...], ...]  # The rows
    denominator: int = 1  # Positive

    def __post_init__(self) -> None:
        """Take integers of any kind as those of Python, which never overflow."""
        rows = tuple(tuple(map(index, row)) for row in self.numerators)
        object.__setattr__(self, "numerators", rows)
        object.__setattr__(self, "denominator", index(self.denominator))

    @classmethod
    def from_rows(cls, rows: Rows) -> RationalMatrix:
        """Bring rational rows over their least common denominator.

        Floats are taken for the binary fractions that they are. A TypeError, ValueError or
        OverflowError if an entry is no number, or not finite.
        """
        ratios = [[_integer_ratio(entry) for entry in row] for row in rows]
        denominator = lcm(*(divisor for row in ratios for _, divisor in row))
        numerators = tuple(
            tuple(numerator * (denominator // below) for numerator, below in row) for row in ratios
        )
        return cls(numerators, denominator)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return len(self.numerators), len(self.numerators[0])

    @property
    def is_well_formed(self) -> bool:
        """Whether all rows have one length and the denominator is positive."""
        return self.denominator > 0 and len(set(map(len, self.numerators))) == 1

    def fractions(self) -> list[list[Fraction]]:
        """Return the entries as reduced fractions."""
        return [[Fraction(entry, self.denominator) for entry in row] for row in self.numerators]

    def floats(self) -> list[list[float]]:
        """Return the entries, each rounded once to the nearest double (infinite beyond them)."""
        return [[_to_float(entry, self.denominator) for entry in row] for row in self.numerators]


def exact_fraction(number: Fraction | float) -> Fraction:
    """Return a number as a fraction of Python integers; those of NumPy would overflow."""
    return Fraction(*_integer_ratio(number))


def _integer_ratio(number: Fraction | float) -> tuple[int, int]:
    """Return numerator and positive denominator of the reduced fraction, as Python integers."""
    # Most numbers are fractions already, and reduced.
    fraction = number if type(number) is Fraction else Fraction(number)
    numerator, denominator = fraction.as_integer_ratio()
    return index(numerator), index(denominator)


def identity(n: int) -> RationalMatrix:
    """Return the identity matrix of n rows."""
    return RationalMatrix(tuple(tuple(int(i == j) for j in range(n)) for i in range(n)))


def multiply(left: Rows, right: Rows) -> list[list[Fraction]]:
    """Return the exact matrix product ``left @ right``."""
    columns = list(zip(*right, strict=True))
    return [[_dot(row, column) for column in columns] for row in left]


def leading(M: Sequence[Sequence[Entry]]) -> list[tuple[Entry, ...]]:
    """Return all rows and columns but the last."""
    return [tuple(row[:-1]) for row in M[:-1]]


def with_crossing(M: Sequence[Sequence[Entry]], k: int, row: Sequence[Entry]) -> list[list[Entry]]:
    """Return ``M + e r + r' e'`` for the k-th unit vector e."""
    rows = [list(entries) for entries in M]
    for j, entry in enumerate(row):
        rows[k][j] += entry
        rows[j][k] += entry
    return rows


def bordered(Q: Rows, row: Sequence[Fraction], corner: Fraction) -> RationalMatrix:
    """Return ``[[Q, r'], [r, corner]]``."""
    rows = [[*above, entry] for above, entry in zip(Q, row, strict=True)]
    return RationalMatrix.from_rows([*rows, [*row, corner]])


def _to_float(numerator: int, denominator: int) -> float:
    try:
        return numerator / denominator
    except OverflowError:
        return inf if numerator > 0 else -inf


def _dot(left: Iterable[Fraction | int], right: Iterable[Fraction | int]) -> Fraction:
    return sum((Fraction(a) * b for a, b in zip(left, right, strict=True)), Fraction(0))
