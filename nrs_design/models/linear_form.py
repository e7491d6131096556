"""Linear forms of a state: the row of coefficients by which a signal follows from it, exactly."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

LinearForm = Sequence[Fraction]

# Made once: forms consist of little else.
ZERO, ONE = Fraction(0), Fraction(1)


def combine(*terms: tuple[Fraction, LinearForm]) -> list[Fraction]:
    """Return the sum of forms, each times its factor; most coefficients are zero."""
    (factor, form), *others = terms
    total = [*form] if factor == 1 else [factor * c if c else ZERO for c in form]
    for factor, form in others:
        pairs = zip(total, form, strict=True)
        # A factor of one is frequent: skip the product.
        if factor == 1:
            total = [(entry + c if entry else c) if c else entry for entry, c in pairs]
        else:
            total = [
                (entry + factor * c if entry else factor * c) if c else entry for entry, c in pairs
            ]
    return total


def coordinates(size: int) -> list[list[Fraction]]:
    """Return the forms that give the states themselves."""
    return [[ONE if i == j else ZERO for j in range(size)] for i in range(size)]


def zero(size: int) -> list[Fraction]:
    """Return the form of a signal that is absent."""
    return [ZERO] * size
