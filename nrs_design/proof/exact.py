"""TRUSTED: exact decisions about integer matrices, in plain Python integers.

Definiteness and the stability of a mode are decided here and nowhere else. What else a verdict
rests on: the conditions in `nrs_design.proof.evidence` that form these matrices, and, where
a condition holds an exponential (a dwell time in continuous time, a period), the enclosures of
python-flint, which are taken as they are.

A rational matrix is given as integers over a positive denominator; positive factors change
neither definiteness nor the Hurwitz property, so all tests run on integers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations_with_replacement
from math import gcd, lcm
from operator import mul

IntegerMatrix = Sequence[Sequence[int]]
Product = Callable[[IntegerMatrix, IntegerMatrix], list[list[int]]]

# Elimination takes about rows^3 steps on numbers that grow with rows times bits: seconds at this.
MAX_WORK = 10**8
# The characteristic polynomial takes about n^4 products of numbers with up to n times bits.
MAX_SPECTRUM_WORK = 10**9
# From this length on, the time of such a product grows faster than the length.
LONG_BITS = 3000
# Modes over a longer common denominator are not added up.
MAX_DENOMINATOR_BITS = 10**5


class TooLargeError(ArithmeticError):
    """Numbers with so many digits that no exact decision about them ends in reasonable time."""


def is_symmetric(M: IntegerMatrix) -> bool:
    """Tell whether a matrix is square and equal to its transpose."""
    return list(map(tuple, M)) == transpose(M)


def is_too_large(M: IntegerMatrix) -> bool:
    """Tell whether deciding anything about a matrix would take more than some seconds."""
    return len(M) ** 3 * bit_length(M) > MAX_WORK


def spectrum_work(order: int, bits: int) -> int:
    """Predict what deciding where eigenvalues are takes; `MAX_SPECTRUM_WORK` is some seconds.

    Entries, and the denominator if that counts, are smaller in size than ``2^bits``.
    """
    longest = order * bits
    return order**3 * longest * (LONG_BITS + longest) // LONG_BITS


def bit_length(M: IntegerMatrix) -> int:
    """Return b such that all entries are smaller in size than ``2^b``."""
    return max((max(map(int.bit_length, row)) for row in M if row), default=0)


def common_denominator(denominators: Iterable[int]) -> int | None:
    """Return the least common multiple, or None where it is too long to work with."""
    common = 1
    for denominator in denominators:
        common = lcm(common, denominator)
        if common.bit_length() > MAX_DENOMINATOR_BITS:
            return None
    return common


def add(left: IntegerMatrix, right: IntegerMatrix, weight: int = 1) -> list[list[int]]:
    """Return ``left + weight right``."""
    return [
        [a + weight * b for a, b in zip(*rows, strict=True)]
        for rows in zip(left, right, strict=True)
    ]


def scaled(M: IntegerMatrix, factor: int) -> list[list[int]]:
    """Return ``factor M``."""
    return [[factor * entry for entry in row] for row in M]


def is_positive_definite(M: IntegerMatrix) -> bool:
    """Decide whether a symmetric integer matrix is positive definite; others are a ValueError.

    Fraction-free elimination (Bareiss 1968): the k-th pivot is the k-th leading principal minor,
    and by Sylvester's criterion all of them are positive iff M is positive definite.
    """
    if not M or not is_symmetric(M):
        raise ValueError("a definiteness test needs a symmetric matrix")
    # In any order of the states; the least entries first keep the many products at first short.
    states = sorted(range(len(M)), key=lambda i: M[i][i])
    # The rows one after the other, each from its diagonal on.
    entries = [M[i][j] for k, i in enumerate(states) for j in states[k:]]
    order, previous = len(M), 1
    while order:
        pivot, row, tail = entries[0], entries[1:order], entries[order:]
        if pivot <= 0:
            return False
        # In the order of what is left: every entry of the row with itself and all after it.
        pairs = combinations_with_replacement(row, 2)
        entries = [
            (pivot * entry - a * b) // previous for entry, (a, b) in zip(tail, pairs, strict=True)
        ]
        previous, order = pivot, order - 1
    return True


def is_positive_semidefinite(M: IntegerMatrix) -> bool:
    """Decide whether a symmetric integer matrix is positive semidefinite; others are a ValueError.

    Elimination as in `is_positive_definite`, with a symmetric choice of pivots: the Schur
    complement of a positive diagonal entry is positive semidefinite iff the matrix is, and a matrix
    with no positive diagonal entry is positive semidefinite iff it is zero.
    """
    if not M or not is_symmetric(M):
        raise ValueError("a definiteness test needs a symmetric matrix")
    rows = [list(row) for row in M]
    while rows:
        k = max(range(len(rows)), key=lambda i: rows[i][i])
        pivot, pivot_row = rows[k][k], rows[k]
        if pivot <= 0:
            return not any(map(any, rows))
        rest = [i for i in range(len(rows)) if i != k]
        rows = [[pivot * rows[i][j] - pivot_row[i] * pivot_row[j] for j in rest] for i in rest]
        divisor = gcd(*(entry for row in rows for entry in row)) or 1
        rows = [[entry // divisor for entry in row] for row in rows]
    return True


def multiply(left: IntegerMatrix, right: IntegerMatrix) -> list[list[int]]:
    """Return the matrix product; a ValueError if the factors do not fit, or rows are uneven."""
    if any(len(row) != len(right) for row in left):
        raise ValueError("a product needs as many columns on the left as rows on the right")
    columns = transpose(right)
    return [[sum(map(mul, row, column)) for column in columns] for row in left]


def transpose(M: IntegerMatrix) -> list[tuple[int, ...]]:
    """Return the columns as rows."""
    return list(zip(*M, strict=True))


def congruence(L: IntegerMatrix, Q: IntegerMatrix, multiply: Product = multiply) -> list[list[int]]:
    """Return ``L' Q L``."""
    return multiply(transpose(L), multiply(Q, L))


def characteristic_polynomial(N: IntegerMatrix) -> list[int]:
    """Return the integer coefficients of ``det(s I - N)``, highest power first.

    Faddeev-LeVerrier recursion; every division is exact.
    """
    n = len(N)
    coefficients = [1]
    M = [[0] * n for _ in range(n)]
    for k in range(1, n + 1):
        for i in range(n):
            M[i][i] += coefficients[-1]
        M = multiply(N, M)
        coefficients.append(-sum(M[i][i] for i in range(n)) // k)
    return coefficients


def is_hurwitz_polynomial(coefficients: Sequence[int]) -> bool:
    """Decide whether all roots have negative real parts.

    Coefficients begin with the highest power, which is not zero. Routh's scheme. Each row is
    multiplied by a positive integer to stay in integers and divided by its greatest common divisor
    to stay small; neither changes a sign. With a positive leading coefficient, the roots are all in
    the open left half-plane iff the scheme runs to its end with a positive first column.
    """
    if coefficients[0] < 0:
        coefficients = [-c for c in coefficients]
    upper, row = list(coefficients[0::2]), list(coefficients[1::2])
    for _ in range(len(coefficients) - 1):
        if row[0] <= 0:
            return False
        shifted = row[1:] + [0] * (len(upper) - len(row))
        lower = [row[0] * a - upper[0] * r for a, r in zip(upper[1:], shifted, strict=True)]
        divisor = gcd(*lower) or 1
        upper, row = row, [entry // divisor for entry in lower]
    return True


def is_hurwitz(N: IntegerMatrix) -> bool:
    """Decide whether N, and so N over any positive number, has its spectrum left of the axis."""
    return is_hurwitz_polynomial(characteristic_polynomial(N))


def is_schur(N: IntegerMatrix, denominator: int) -> bool:
    """Decide whether all eigenvalues of ``N / denominator`` are inside the unit circle.

    The map ``z = (1 + s) / (1 - s)`` takes the open left half-plane onto the open unit disk, so
    the polynomial ``(1 - s)^n p((1 + s) / (1 - s))`` is tested for the Hurwitz property. Its
    leading coefficient vanishes iff -1 is an eigenvalue.
    """
    # Horner's scheme on ``sum c_k (d (1 + s))^(n - k) (1 - s)^k``.
    mapped, power = [1], [1]
    for c in characteristic_polynomial(N)[1:]:
        power, product = _times_binomial(power, -1), _times_binomial(mapped, 1)
        mapped = [denominator * a + c * b for a, b in zip(product, power, strict=True)]
    return mapped[0] != 0 and is_hurwitz_polynomial(mapped)


def _times_binomial(polynomial: Sequence[int], slope: int) -> list[int]:
    """Return the product with ``slope s + 1``, the highest power first."""
    return [slope * a + b for a, b in zip([*polynomial, 0], [0, *polynomial], strict=True)]
