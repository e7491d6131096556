"""The ladder of every rounding: how far below the best rate to claim, and with how many digits.

Rates descend, and for each rate the digits grow. A wider gap below the best rate needs fewer
digits, and the first candidate that passes the exact check is taken.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from math import floor, isfinite

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time

BACK_OFFS = (0.99995, 0.9998, 0.9995, 0.999, 0.998, 0.996, 0.99, 0.9, 0.5, 0.1, 1e-2, 1e-3, 1e-4)
BITS = (4, 6, 8, 10, 12, 16, 20, 24, 32, 40, 50, 60)
# Where a check takes long: so many rates, and every so many bits.
FEW_RATES = 3
RATE_BITS = 16


def rate_at(position: float, limit: float, time: Time) -> float:
    """Return the rate, in 1/s or per step, at a position from 0, mere stability, to 1."""
    return position * limit if time is Time.CONTINUOUS else 1 - position * (1 - limit)


def position_of(rate: float, limit: float, time: Time) -> float:
    """Return the position of a rate: the inverse of `rate_at`."""
    return rate / limit if time is Time.CONTINUOUS else (1 - rate) / (1 - limit)


def claims(
    position: float, limit: float, time: Time, nearest: float = BACK_OFFS[0], *, few: bool = False
) -> Iterator[Fraction]:
    """Yield short rates of exponential decay below a position, the fastest decay first.

    At most the share `nearest` of the position is claimed; `few`: not all of them.
    """
    back_offs = (back_off for back_off in BACK_OFFS if back_off <= nearest)
    for back_off in islice(back_offs, FEW_RATES if few else None):
        rate = rate_at(position * back_off, limit, time)
        if not isfinite(rate):
            continue
        claim = round_rate(rate, time)
        if claim > 0 and (time is Time.CONTINUOUS or claim < 1):
            yield claim


def digits(fewest: int = BITS[0]) -> tuple[int, ...]:
    """Return numbers of bits after the binary point, from the fewest on."""
    return tuple(bits for bits in BITS if bits >= fewest)


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


def round_form(
    M: NDArray[np.float64], shifts: NDArray[np.int64], bits: int
) -> tuple[tuple[int, ...], ...]:
    """Round a symmetric matrix to integers over ``2^bits``, then scale exactly, ``2^s M 2^s``."""
    return round_matrix((M + M.T) / 2, shifts, bits)


def round_matrix(
    M: NDArray[np.float64], shifts: NDArray[np.int64], bits: int
) -> tuple[tuple[int, ...], ...]:
    """Do the same with any matrix.

    No shift s is negative; bits may be. An OverflowError beyond the range of floating point.
    """
    rounded = np.ldexp(M, bits)
    if not np.isfinite(rounded).all():
        raise OverflowError("a form beyond the range of floating point")
    return tuple(
        tuple(round(float(v)) << int(si + sj) for v, sj in zip(row, shifts, strict=True))
        for row, si in zip(rounded, shifts, strict=True)
    )


def unscale(
    Q: NDArray[np.float64], exponents: NDArray[np.int64], bits: int
) -> tuple[tuple[tuple[int, ...], ...], int]:
    """Round to integers over ``2^bits`` and undo the scaling exactly, ``2^-d Q 2^-d``.

    Returns the integers, and the logarithm of their denominator, two to a power of at least zero.
    """
    top = int(exponents.max())
    rows, log2 = round_form(Q, top - exponents, bits), bits + 2 * top
    return (rows, log2) if log2 >= 0 else (tuple(tuple(v << -log2 for v in row) for row in rows), 0)


def numerators(multipliers: NDArray[np.float64], log2: int) -> tuple[int, ...]:
    """Round multipliers to integers over two to a power; none becomes negative."""
    whole = Fraction(2) ** log2
    return tuple(round(max(Fraction(float(entry)), Fraction(0)) * whole) for entry in multipliers)
