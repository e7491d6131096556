"""Linear forms of a state: the row of coefficients by which a signal follows from it, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

LinearForm = Sequence[Fraction]


def combine(*terms: tuple[Fraction, LinearForm]) -> list[Fraction]:
    """Return the sum of forms, each times its factor; most coefficients are zero."""
    (factor, form), *others = terms
    total = [*form] if factor == 1 else [factor * c if c else Fraction(0) for c in form]
    for factor, form in others:
        pairs = zip(total, form, strict=True)
        # Most factors are one.
        if factor == 1:
            total = [entry + c if c else entry for entry, c in pairs]
        else:
            total = [entry + factor * c if c else entry for entry, c in pairs]
    return total


def coordinates(size: int) -> list[list[Fraction]]:
    """Return the forms that give the states themselves."""
    return [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]


def zero(size: int) -> list[Fraction]:
    """Return the form of a signal that is absent."""
    return [Fraction(0)] * size
