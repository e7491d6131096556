"""Exponentials in Python integers: a Taylor series, its remainder bounded, and squaring.

Of matrices it has no first word: where flint encloses an exponential, this must meet the enclosure.
The exponential of a number, as a sampled motor has it, is enclosed here.
"""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from nrs_design.proof.exact import IntegerMatrix, add, multiply
from nrs_design.proof.matrix import RationalMatrix

# Numbers are integers over two to this power.
BITS = 256
UNIT = 2**BITS
# The series is summed for an exponent with row sums of at most two to minus this power.
SMALL = 8
TERMS = 24
# The bounds on the exponential of a number are integers over two to this power.
BOUND_BITS = 80


def exponential_nearly(A: RationalMatrix, time: Fraction) -> tuple[RationalMatrix, Fraction]:
    """Return M and e such that the row sums of ``|exp(A t) - M|`` are at most e, t >= 0 in s.

    ``exp(A t) = exp(X)^(2^h)`` with ``|X| <= 2^-8`` in the norm of the largest row sum. In units:
    rounding X changes it by at most n, and so exp(X) by less than 2 n; the n rounded entries of a
    row in each of Horner's steps add up to less than 2 n, because a step makes earlier errors
    smaller by half; the terms from the 25th on are less than 1. A square has at most the error
    ``2 |E| e + e^2``, and n from rounding.
    """
    n = A.shape[0]
    size = max(sum(map(abs, row)) for row in A.numerators) * time / A.denominator
    halvings = ceil(size * 2**SMALL).bit_length()
    scale = time * UNIT / A.denominator / 2**halvings
    X = [[round(entry * scale) for entry in row] for row in A.numerators]
    identity = [[UNIT * (i == j) for j in range(n)] for i in range(n)]
    E: IntegerMatrix = identity
    for k in range(TERMS, 0, -1):
        E = add(identity, _divided(multiply(X, E), k * UNIT))
    error = Fraction(4 * n + 1)
    for _ in range(halvings):
        norm = Fraction(max(sum(map(abs, row)) for row in E), UNIT)
        # An upper bound of few digits, so that exact errors do not become long.
        error = Fraction(ceil(2 * norm * error + error**2 / UNIT + n))
        E = _divided(multiply(E, E), UNIT)
    return RationalMatrix(tuple(map(tuple, E)), UNIT), error / UNIT


def exponential_between(x: Fraction) -> tuple[Fraction, Fraction]:
    """Return bounds below and above exp(x), of few digits."""
    E, error = exponential_nearly(RationalMatrix.from_rows([[x]]), Fraction(1))
    value, unit = Fraction(E.numerators[0][0], E.denominator), 2**BOUND_BITS
    return Fraction(floor((value - error) * unit), unit), Fraction(
        ceil((value + error) * unit), unit
    )


def _divided(M: IntegerMatrix, divisor: int) -> IntegerMatrix:
    """Return a quotient, each entry of which is less than one below."""
    return [[entry // divisor for entry in row] for row in M]
