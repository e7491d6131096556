"""TRUSTED: what a cost of two gains surely does not fall below, by branch and bound with balls.

At a frequency omega an admittance is ``y = Bt + j X`` with ``X = Mt omega - Kt/omega``; with the
open loop F in the place of y = 1 the sensitivity there is ``L = y/(y + F)``. The cost is the mean
over frequencies of ``wD |t - log10|L|| + wR |L|``: thesis 6.4 to 6.7, as the finite sum that is
minimized, so there is no error of a quadrature.

Over a box of Mt and Bt, ``|a| >= s a`` for either sign s. With signs as they are in the middle m,
what is left is smooth, and not below ``value at m - sum of |slope over the box| * half width``
(mean value form; Ratschek and Rokne 1984, "Computer methods for the range of functions"). Boxes
where that says too little are halved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import count
from typing import Any

from nrs_design.proof.enclosure import fraction_of, precision

# Bits of the balls.
_BITS = 64

Ends = tuple[Fraction, Fraction]


@dataclass(frozen=True, slots=True)
class Frequency:
    """What the cost takes at one frequency; all numbers are exact."""

    omega: Fraction  # rad/s, positive
    drawn: Fraction  # Kt/omega
    real: Fraction  # Of F
    imag: Fraction
    # (Zdes/|F without the filter of the force|)^2, whose logarithm is 2 t.
    target: Fraction


@dataclass(frozen=True, slots=True)
class LeastCost:
    """A bound on a cost over a box of gains."""

    below: Fraction  # Nowhere in the box is the cost smaller
    boxes: int  # That were looked at


def least_cost(
    frequencies: Sequence[Frequency],
    weights: tuple[Fraction, Fraction],
    Mt: Ends,
    Bt: Ends,
    *,
    enough: Fraction,
    most: int,
) -> LeastCost:
    """Bound the least cost over a box of gains from below.

    Parameters
    ----------
    frequencies : sequence of Frequency
        Over which the cost is a mean.
    weights : tuple of Fraction
        wD and wR, not negative.
    Mt, Bt : tuple of Fraction
        Lowest and highest virtual mass (not negative) and damping (positive).
    enough : Fraction
        The search ends when the bound is at least this.
    most : int
        Boxes that are looked at, at least one.
    """
    with precision(_BITS):
        cost = _Cost.of(frequencies, weights)
        order, looked = count(1), 1
        open_ = [cost.bound((Mt, Bt), next(order))]
        while open_[0].below < enough and looked + 2 <= most:
            for half in heappop(open_).halves():
                looked += 1
                heappush(open_, cost.bound(half, next(order)))
        return LeastCost(open_[0].below, looked)
