"""TRUSTED: what flint encloses in balls, and how a ball becomes integers that are surely below.

The one file of the proof that asks a library. A matrix of balls contains the true
one: what is shown for every matrix in it is shown for that.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from fractions import Fraction
from functools import reduce
from typing import Any

from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix

PRECISION = 300
MIDPOINT_BITS = 160
GUARD_BITS = 64
# Balls beyond this fail; what is nearer to zero than its inverse counts as zero with that radius.
RANGE_LOG2 = 32_768


@contextmanager
def precision(bits: int = PRECISION) -> Iterator[None]:
    """Let flint compute with so many bits meanwhile."""
    from flint import ctx

    before, ctx.prec = ctx.prec, bits
    try:
        yield
    finally:
        ctx.prec = before


def balls(A: RationalMatrix) -> Any:
    """Return a matrix of balls around a rational matrix, at the current precision."""
    from flint import arb_mat

    return arb_mat(_fmpq_matrix(A))


def all_between(matrices: Iterable[Any]) -> Any:
    """Return balls that contain all combinations of matrices of balls."""
    from flint import arb_mat

    first, *others = matrices
    if not others:
        return first
    rows, columns = range(first.nrows()), range(first.ncols())
    return arb_mat(
        [
            [reduce(lambda a, b: a.union(b), (M[i, j] for M in (first, *others))) for j in columns]
            for i in rows
        ]
    )


def exponential(A: RationalMatrix, begin: Fraction, end: Fraction) -> Any:
    """Return balls that contain ``exp(A t)`` for all t from begin to end; A is in 1/s, t in s.

    The times are those around their middle: ``exp(A t) = exp(A d) exp(A m)`` with d in a ball
    around zero.
    """
    from flint import arb_mat, fmpq

    middle, half = (begin + end) / 2, (end - begin) / 2
    exact = _fmpq_matrix(A)
    E = arb_mat(exact * fmpq(middle.numerator, middle.denominator)).exp()
    return exponential_near_zero(arb_mat(exact), half) * E if half > 0 else E


def exponential_near_zero(A: Any, half: Fraction) -> Any:
    """Return balls that contain ``exp(A t)`` for all t from ``-half`` to ``half``, in s."""
    ball = ball_around(half)
    return (A * (-ball).union(ball)).exp()


def unit_coordinates(form: Any) -> Any:
    """Return an exact T with ``T' F T`` near the identity; the identity if F is not definite."""
    from flint import arb_mat

    n = form.nrows()
    L, as_it_is = arb_mat(n, n), arb_mat(n, n, [int(a == b) for a in range(n) for b in range(n)])
    for j in range(n):
        for i in range(j, n):
            rest = form[i, j]
            for k in range(j):
                rest -= L[i, k] * L[j, k]
            if i == j and not rest > 0:
                return as_it_is
            L[i, j] = rest.sqrt() if i == j else rest / L[j, j]
    try:
        T = L.inv().transpose().mid()
        T.inv()
    except ZeroDivisionError:  # Not invertible for certain.
        return as_it_is
    return T


def overlap(enclosed: Any, M: RationalMatrix, error: Fraction) -> bool:
    """Tell whether balls overlap, entry by entry, those of one radius around a rational matrix."""
    radius, ours = ball_around(error), balls(M)
    around, (rows, columns) = (-radius).union(radius), M.shape
    return all(
        (ours[i, j] + around).overlaps(enclosed[i, j]) for i in range(rows) for j in range(columns)
    )


def eigenvalues(A: RationalMatrix) -> list[Any]:
    """Return complex balls that contain all eigenvalues, each as often as it occurs."""
    from flint import fmpz_mat

    rows = [list(row) for row in A.numerators]
    roots: list[Any] = fmpz_mat(rows).charpoly().complex_roots()
    return [root / A.denominator for root, count in roots for _ in range(count)]


def characteristic_sign(M: Any, number: Fraction) -> int:
    """Return the sign of ``det(number I - M)`` for all matrices in M; 0 if it is not certain."""
    value = M.charpoly()(ball_around(number))
    return 1 if value > 0 else -1 if value < 0 else 0


def eigenvector(M: Any, low: Fraction, high: Fraction) -> Any:
    """Return balls around an eigenvector for an eigenvalue between two numbers, or None.

    Where the characteristic polynomial p has opposite signs at the two, there is a root z between
    them. By Cayley and Hamilton, ``v(z) = adj(z I - M) u`` has ``(z I - M) v(z) = p(z) u = 0``; it
    is enclosed for all numbers in between. What is returned may enclose zero, which is none.
    """
    from flint import arb_mat

    if characteristic_sign(M, low) * characteristic_sign(M, high) >= 0:
        return None
    z, n, coefficients = ball_around(low).union(ball_around(high)), M.nrows(), M.charpoly().coeffs()
    v = w = u = arb_mat(n, 1, [1] * n)
    # Horner's scheme, with w_(n-1) = u and w_(j-1) = M w_j + c_j u.
    for c in coefficients[n - 1 : 0 : -1]:
        w = M * w + u * c
        v = v * z + w
    return v


def lower_integers(form: Any) -> IntegerMatrix:
    """Return integers that are below a symmetric matrix of balls times a number > 0.

    If every entry is within r_ij of a rational midpoint, ``|x_i x_j| <= (x_i^2 w_i/w_j + x_j^2
    w_j/w_i)/2`` for any weights w > 0, so the form is at least that of the midpoints minus
    ``sum_j r_ij w_i/w_j`` on the diagonal. With roots of the diagonal as weights, states in
    different units cost nothing.
    """
    n = form.nrows()
    # Both triangles enclose the same number: take the upper one, whatever the lower one is.
    upper = {(i, j): form[i, j] for i in range(n) for j in range(i, n)}
    if not all(ball.is_finite() for ball in upper.values()):
        return [[0] * n for _ in range(n)]
    mids = {k: _binary(ball.mid()) for k, ball in upper.items()}
    radii = {k: _binary(ball.rad()) for k, ball in upper.items()}
    if any(_log2(number) > RANGE_LOG2 for number in (*mids.values(), *radii.values())):
        return [[0] * n for _ in range(n)]
    # The largest midpoint becomes one of so many bits, and one more.
    shift = MIDPOINT_BITS + 1 - max((_log2(mid) for mid in mids.values() if mid[0]), default=1)
    # Rounding costs a midpoint less than one; and both it and its radius may have been taken for
    # zero. Slacks are counted in units of their own.
    margin = (1 << GUARD_BITS) + _ceil((2, -RANGE_LOG2), shift + GUARD_BITS)
    slacks = {k: _ceil(radius, shift + GUARD_BITS) + margin for k, radius in radii.items()}
    weights = [(_log2(mids[k, k]) - 1) // 2 if mids[k, k][0] > 0 else 0 for k in range(n)]
    lower, sums = [[0] * n for _ in range(n)], [0] * n
    for (i, j), slack in slacks.items():
        lower[i][j] = lower[j][i] = _floor(mids[i, j], shift)
        difference = weights[i] - weights[j]
        sums[i] += _ceil((slack, difference), 0)
        if i != j:
            sums[j] += _ceil((slack, -difference), 0)
    for k, total in enumerate(sums):
        lower[k][k] -= (total >> GUARD_BITS) + 1
    return lower


# An integer times two to a power.
_Binary = tuple[int, int]


def _binary(ball: Any) -> _Binary:
    """Return an exact ball (of radius zero), or zero for one very near to it."""
    mantissa, exponent = ball.man_exp()
    number = int(mantissa), int(exponent)
    return (0, 0) if _log2(number) < -RANGE_LOG2 else number


def _log2(number: _Binary) -> int:
    """Return the least n such that a number is smaller than two to the n; 0 for zero."""
    return number[0].bit_length() + number[1]


def _floor(number: _Binary, shift: int) -> int:
    """Return the largest integer that is not above a number times two to a power."""
    exponent = number[1] + shift
    return number[0] << exponent if exponent >= 0 else number[0] >> -exponent


def _ceil(number: _Binary, shift: int) -> int:
    """Return the least integer that is not below a number times two to a power."""
    return -_floor((-number[0], number[1]), shift)


def fraction_of(ball: Any) -> Fraction:
    """Return an exact ball (of radius zero), such as an end of another one, as a fraction."""
    mantissa, exponent = ball.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)


def ball_around(number: Fraction) -> Any:
    """Return a ball around a number, at the current precision."""
    from flint import arb, fmpq

    return arb(fmpq(number.numerator, number.denominator))


def between_zero_and(number: Fraction) -> Any:
    """Return a ball that contains all numbers from zero to one, at the current precision."""
    return ball_around(Fraction(0)).union(ball_around(number))


def _fmpq_matrix(A: RationalMatrix) -> Any:
    from flint import fmpq, fmpq_mat

    return fmpq_mat(*A.shape, [fmpq(v, A.denominator) for row in A.numerators for v in row])
