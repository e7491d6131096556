"""TRUSTED: whether a mode is stable, decided exactly; its worst eigenvalue, for the reader."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from nrs_design.proof.enclosure import eigenvalues
from nrs_design.proof.exact import (
    MAX_SPECTRUM_WORK,
    TooLargeError,
    bit_length,
    is_hurwitz,
    is_schur,
    spectrum_work,
)
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode, Time


def is_stable(A: RationalMatrix, time: Time) -> bool:
    """TRUSTED: decide whether a matrix is Hurwitz (continuous time) or Schur (discrete time).

    A `TooLargeError` if that would take more than some seconds.
    """
    _check_size(A)
    if time is Time.CONTINUOUS:
        return is_hurwitz(A.numerators)
    return is_schur(A.numerators, A.denominator)


def worst_eigenvalue(A: RationalMatrix, time: Time) -> str:
    """Return the eigenvalue nearest to or farthest beyond the stability limit, to six digits.

    A `TooLargeError` if that would take more than some seconds.
    """
    _check_size(A)
    centers = [complex(ball) for ball in eigenvalues(A)]
    z = max(centers, key=lambda z: z.real if time is Time.CONTINUOUS else abs(z))
    if abs(z.imag) <= 1e-14 * abs(z):
        return f"{z.real:.6g}"
    return f"{z.real:.6g} +- {abs(z.imag):.6g}j"


def affordable(modes: Iterable[Mode]) -> Iterator[tuple[Mode, bool]]:
    """Yield modes, each with whether it can be decided within some seconds for all of them."""
    spent = 0
    for mode in modes:
        work = _work(mode.A)
        fits = spent + work <= MAX_SPECTRUM_WORK
        spent += work * fits
        yield mode, fits


def _check_size(A: RationalMatrix) -> None:
    if _work(A) > MAX_SPECTRUM_WORK:
        raise TooLargeError(
            "the numbers of a mode are too large to decide exactly whether it is stable"
        )


def _work(A: RationalMatrix) -> int:
    bits = max(bit_length(A.numerators), A.denominator.bit_length())
    return spectrum_work(len(A.numerators), bits)
