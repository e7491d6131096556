"""TRUSTED: what a stay in a mode makes of the state, exactly or enclosed."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import lru_cache

from nrs_design.proof.enclosure import balls, exponential, lower_integers, precision
from nrs_design.proof.evidence.fields import Matrix
from nrs_design.proof.exact import IntegerMatrix
from nrs_design.proof.matrix import RationalMatrix, multiply
from nrs_design.proof.switching import Edge


# Asked for at every switch from a mode.
@lru_cache(maxsize=256)
def power(A: RationalMatrix, exponent: int) -> RationalMatrix:
    """Return the power of a square matrix."""
    n = A.shape[0]
    result = RationalMatrix.from_rows([[int(i == j) for j in range(n)] for i in range(n)])
    for bit in bin(exponent)[2:]:
        result = RationalMatrix.from_rows(multiply(result.fractions(), result.fractions()))
        if bit == "1":
            result = RationalMatrix.from_rows(multiply(A.fractions(), result.fractions()))
    return result


def shifted(A: RationalMatrix, rate: Fraction) -> RationalMatrix:
    """Return ``A + rate I``."""
    rows = A.fractions()
    for i, row in enumerate(rows):
        row[i] += rate
    return RationalMatrix.from_rows(rows)


def enclosed_form(
    edge: Edge, times: tuple[Fraction, Fraction], Q: Mapping[str, Matrix], rate: Fraction
) -> IntegerMatrix:
    """Return integers below the true form, for all times from one to another, times a number > 0.

    The form ``Q_i - E' Q_j E`` with ``E = G exp(B t)`` is enclosed in balls.

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
    with precision():
        E = exponential(shifted(edge.source.A, rate), *times)
        if edge.map is not None:
            E = balls(edge.map) * E
        Qi, Qj = (balls(RationalMatrix(Q[mode.name])) for mode in (edge.source, edge.target))
        return lower_integers(Qi - E.transpose() * Qj * E)
