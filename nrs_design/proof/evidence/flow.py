"""TRUSTED: what a stay in a mode makes of the state, exactly or enclosed."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix, multiply
from nrs_design.proof.system import Edge

PRECISION = 300
MIDPOINT_BITS = 160
# Balls beyond this fail; what is nearer to zero than its inverse counts as zero with that radius.
RANGE_LOG2 = 32_768


def power(A: RationalMatrix, exponent: int) -> RationalMatrix:
    """Return the power of a square matrix."""
    n = A.shape[0]
    result = RationalMatrix.from_rows([[int(i == j) for j in range(n)] for i in range(n)])
    for bit in bin(exponent)[2:]:
        result = RationalMatrix.from_rows(multiply(result.fractions(), result.fractions()))
        if bit == "1":
            result = RationalMatrix.from_rows(multiply(A.fractions(), result.fractions()))
    return result


def enclosed_form(
    edge: Edge, times: tuple[Fraction, Fraction], Q: Mapping[str, Matrix], rate: Fraction
) -> IntegerMatrix:
    """Return integers below the true form, for all times from one to another, times a number > 0.

    The form ``Q_i - E' Q_j E`` with ``E = G exp(B t)`` is enclosed in balls. If every entry is
    within r of a rational midpoint, then its smallest eigenvalue is at least that of the midpoint
    minus n r, so that much is subtracted from the diagonal. The times are those around their
    middle: ``exp(B t) = exp(B d) exp(B m)`` with d in a ball around zero.

    Parameters
    ----------
    edge : Edge
        Mode, next mode and reset.
    times : tuple of Fraction
        The first and the last, in s.
    Q : mapping
        The forms by mode.
    rate : Fraction
        The alpha in 1/s.
    """
    from flint import arb, arb_mat, ctx, fmpq, fmpq_mat, fmpz_mat

    before, ctx.prec = ctx.prec, PRECISION
    try:
        A, n = edge.source.A, edge.source.A.shape[0]
        shifted = [
            Fraction(v, A.denominator) + (rate if i == j else 0)
            for i, row in enumerate(A.numerators)
            for j, v in enumerate(row)
        ]
        B = fmpq_mat(n, n, [fmpq(v.numerator, v.denominator) for v in shifted])
        middle, half = (times[0] + times[1]) / 2, (times[1] - times[0]) / 2
        E = arb_mat(B * fmpq(middle.numerator, middle.denominator)).exp()
        if half > 0:
            ball = arb(fmpq(half.numerator, half.denominator))
            E = (arb_mat(B) * (-ball).union(ball)).exp() * E
        if edge.map is not None:
            flat = [fmpq(v, edge.map.denominator) for row in edge.map.numerators for v in row]
            E = arb_mat(fmpq_mat(*edge.map.shape, flat)) * E
        Qi, Qj = (
            arb_mat(fmpz_mat([list(r) for r in Q[m.name]])) for m in (edge.source, edge.target)
        )
        form = Qi - E.transpose() * Qj * E
        return _lower_integers([[form[i, j] for j in range(n)] for i in range(n)])
    finally:
        ctx.prec = before


def _lower_integers(form: list[list[Any]]) -> IntegerMatrix:
    """Return integers that are below a symmetric ball matrix times a power of two."""
    n = len(form)
    if any(not ball.abs_upper() < 2**RANGE_LOG2 for row in form for ball in row):
        return [[0] * n for _ in range(n)]
    mids = [[_fraction(form[i][j].mid()) for j in range(n)] for i in range(n)]
    radius = max(_fraction(form[i][j].rad()) for i in range(n) for j in range(n))
    # Both a midpoint and a radius may have been taken for zero.
    radius += 2 * Fraction(1, 2**RANGE_LOG2)
    # Both triangles enclose the same number: take the upper one, and let the radius cover it.
    scale = 2**MIDPOINT_BITS
    largest = max((abs(v) for row in mids for v in row), default=Fraction(1)) or Fraction(1)
    unit = Fraction(scale) / largest
    slack = n * (radius * unit + 1)
    rounded = [[round(mids[min(i, j)][max(i, j)] * unit) for j in range(n)] for i in range(n)]
    return [[rounded[i][j] - (int(slack) + 1 if i == j else 0) for j in range(n)] for i in range(n)]


def _fraction(ball: Any) -> Fraction:
    """Return an exact ball (of radius zero) as a fraction, or zero for one very near to it."""
    mantissa, exponent = ball.man_exp()
    if int(mantissa).bit_length() + int(exponent) < -RANGE_LOG2:
        return Fraction(0)
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
