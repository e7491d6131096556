"""Round a floating-point candidate to integers, with as few bits as pass the exact check."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from math import floor, gcd

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import CommonQuadratic
from nrs_design.proof.system import Time
from nrs_design.search.checker import Checker

BITS = (4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 50, 60)
RATE_BITS = 16

Screen = Callable[[NDArray[np.float64]], bool]


def round_to_evidence(
    checker: Checker,
    Q: NDArray[np.float64],
    exponents: NDArray[np.int64],
    rate: Fraction,
    passes: Screen = lambda rounded: True,
) -> CommonQuadratic | None:
    """Return exact evidence near a candidate, or None if no rounding of it passes.

    Parameters
    ----------
    checker : Checker
        Of the exact modes, in their own coordinates.
    Q : ndarray, shape (n, n)
        Candidate in the coordinates scaled by ``2^d``.
    exponents : ndarray of int, shape (n,)
        The d of `nrs_design.search.balance.balance`.
    rate : Fraction
        Rate to claim.
    passes : callable
        Tells in floating point, of a rounded candidate, whether the exact check is worth its time.
    """
    largest = np.abs(Q).max()
    if not np.isfinite(largest) or largest == 0:
        return None
    unit = np.ldexp(Q, -int(np.frexp(largest)[1]))
    for bits in BITS:
        rounded = np.ldexp(np.rint(np.ldexp((unit + unit.T) / 2, bits)), -bits)
        if bits < BITS[-1] and not passes(rounded):
            continue
        evidence = _evidence(unit, exponents, bits, rate)
        if checker.find_fault(evidence) is None:
            return evidence
    return None


def round_rate(rate: float | Fraction, time: Time) -> Fraction:
    """Round a rate to a short dyadic number on its safe side (slower decay)."""
    if time is Time.DISCRETE:
        return 1 - _round_down(1 - Fraction(rate))
    return _round_down(Fraction(rate))


def _round_down(value: Fraction) -> Fraction:
    size = value.numerator.bit_length() - value.denominator.bit_length()
    if value >= Fraction(2) ** size:
        size += 1
    unit = Fraction(2) ** (size - RATE_BITS)
    return floor(value / unit) * unit


def unscale(
    Q: NDArray[np.float64], exponents: NDArray[np.int64], bits: int
) -> tuple[tuple[tuple[int, ...], ...], int]:
    """Round to integers over ``2^bits`` and undo the scaling exactly, ``2^-d Q 2^-d``.

    Parameters
    ----------
    Q : ndarray, shape (n, n)
        In scaled coordinates.
    exponents : ndarray of int, shape (n,)
        The d.
    bits : int
        After the binary point.

    Returns
    -------
    tuple
        The integers, and the logarithm of their denominator, which is two to a power.
    """
    shifts = [int(exponents.max() - e) for e in exponents]
    rows = tuple(
        tuple(round(float(q) * 2.0**bits) << (si + sj) for q, sj in zip(row, shifts, strict=True))
        for row, si in zip((Q + Q.T) / 2, shifts, strict=True)
    )
    return rows, bits + 2 * int(exponents.max())


def _evidence(
    Q: NDArray[np.float64], exponents: NDArray[np.int64], bits: int, rate: Fraction
) -> CommonQuadratic:
    """Round, and drop common factors of two: the scale of Q is free."""
    rows, denominator_log2 = unscale(Q, exponents, bits)
    common = gcd(*(entry for row in rows for entry in row)) or 1
    twos = (common & -common).bit_length() - 1
    reduced = tuple(tuple(entry >> twos for entry in row) for row in rows)
    return CommonQuadratic(reduced, max(denominator_log2 - twos, 0), rate)
