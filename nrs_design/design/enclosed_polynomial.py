"""Polynomials whose coefficients lie between rational numbers.

What is said of one is said of every polynomial with such coefficients.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import zip_longest
from math import floor

# A number between two rational ones, and a polynomial with such coefficients, the constant first.
Enclosed = tuple[Fraction, Fraction]
Polynomial = list[Enclosed]

# Binary digits that are kept of a coefficient that is shortened.
DIGITS = 64
NOTHING = (Fraction(0), Fraction(0))


def exactly(number: Fraction | int) -> Enclosed:
    """Enclose a rational number by itself."""
    return Fraction(number), Fraction(number)


def numbers(*coefficients: Fraction | int) -> Polynomial:
    """Return a polynomial with these coefficients, the constant first."""
    return [exactly(c) for c in coefficients]


def negative(a: Enclosed) -> Enclosed:
    """Enclose minus a number."""
    return -a[1], -a[0]


def plus(a: Enclosed, b: Enclosed) -> Enclosed:
    """Enclose a sum of numbers."""
    return a[0] + b[0], a[1] + b[1]


def times(a: Enclosed, b: Enclosed) -> Enclosed:
    """Enclose a product of numbers."""
    ends = [x * y for x in a for y in b]
    return min(ends), max(ends)


def add(P: Polynomial, Q: Polynomial) -> Polynomial:
    """Enclose a sum of polynomials."""
    return [plus(a, b) for a, b in zip_longest(P, Q, fillvalue=NOTHING)]


def multiply(P: Polynomial, Q: Polynomial) -> Polynomial:
    """Enclose a product of polynomials."""
    product = [NOTHING] * (len(P) + len(Q) - 1)
    for i, a in enumerate(P):
        for j, b in enumerate(Q):
            product[i + j] = plus(product[i + j], times(a, b))
    return product


def in_tangent(P: Polynomial, degree: int) -> Polynomial:
    """Return ``(1 - w)^degree P((1 + w)/(1 - w))``, a polynomial in w, the constant first.

    On ``w = j tan(omega T/2)`` the quotient is ``exp(j omega T)``.
    """
    total: Polynomial = []
    for k, c in enumerate(P):
        term = [c]
        for i in range(degree):
            term = multiply(term, numbers(1, 1) if i < k else numbers(1, -1))
        total = add(total, term)
    return total


def rounded_outwards(P: Polynomial) -> Polynomial:
    """Round coefficients outwards to few digits."""
    return [(_below(low), -_below(-high)) for low, high in P]


def _below(number: Fraction) -> Fraction:
    if not number:
        return number
    size = number.numerator.bit_length() - number.denominator.bit_length()
    unit = Fraction(2) ** (size - DIGITS)
    return floor(number / unit) * unit
