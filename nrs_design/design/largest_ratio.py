"""The largest quotient of two polynomials over a box, proved between two bounds.

In Bernstein form, the value of a polynomial anywhere in a box is a mean of its coefficients, all
weights being positive. So where every coefficient of the denominator is positive, the quotient is
nowhere above the largest quotient of two coefficients (Narkawicz, Garloff, Smith, Munoz 2012,
"Bounding the range of a rational function over a box"). At the vertices the coefficients are the
values, which bounds the largest quotient from below. Halves of a box have coefficients that are
means of those before (de Casteljau), and the two bounds meet as boxes are halved. Coefficients are
balls: what is said of them is said of every number in them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from heapq import heappop, heappush
from itertools import count, pairwise, product
from math import comb, prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.enclosure import ball_around, fraction_of, precision

# Between the two bounds, as a share of the lower one.
NEARLY = Fraction(1, 400)
# Coefficients that are looked at before the search ends.
MOST = 400_000
ZERO, ONE = Fraction(0), Fraction(1)

Tensor = Sequence[Any]  # Rational numbers or balls, the last index turning fastest
Balls = NDArray[Any]  # The same, an axis for each direction


@dataclass(frozen=True, slots=True)
class LargestRatio:
    """Two bounds on the largest quotient over the unit box."""

    above: Fraction | None  # Nowhere in the box is it larger; None where that was not shown
    below: Fraction  # It is at least this at a point of the box
    at: tuple[Fraction, ...]  # That point, between 0 and 1 in each direction; exact


def largest_ratio(
    numerator: Tensor,
    denominator: Tensor,
    shape: Sequence[int],
    *,
    limit: Fraction | None = None,
    nearly: Fraction | None = NEARLY,
    most: int = MOST,
) -> LargestRatio:
    """Bound the largest value of a quotient of polynomials over the unit box.

    Neither is negative in the box; Bernstein coefficients come in the order of indices, so many in
    each direction. The box with the highest bound is halved until it is decided whether the
    quotient stays below a limit, or until the bounds are as near as a share; what is not shown by
    `most` coefficients is not shown.
    """
    order, spent, size = count(), 0, prod(shape)
    least, at = ZERO, tuple(ZERO for _ in shape)
    open_: list[tuple[bool, Fraction, int, _Box]] = []

    def take(box: _Box) -> None:
        nonlocal least, at
        for value, vertex in box.vertices():
            if value > least:
                least, at = value, vertex
        bound = box.bound()
        # Those without a bound first, then the highest.
        heappush(open_, (bound is not None, -(bound or ZERO), next(order), box))

    with precision():
        above, below = _as_balls(numerator, shape), _as_balls(denominator, shape)
        take(_Box(above, below, tuple((ZERO, ONE) for _ in shape)))
        while True:
            bounded, negative, _, box = open_[0]
            highest = -negative
            met = bounded and (nearly is None or highest <= least * (1 + nearly))
            exceeded = limit is not None and least > limit
            decided = limit is None or exceeded or (bounded and highest <= limit)
            # What exceeds its limit may have no bound at all.
            if (met and decided) or (exceeded and not bounded) or spent > most:
                return LargestRatio(highest if bounded else None, least, at)
            heappop(open_)
            for half in box.halves():
                take(half)
                spent += size


def bernstein(powers: Tensor, low: Any, high: Any) -> list[Any]:
    """Return Bernstein coefficients between two numbers, of powers from the lowest on."""
    n, span = len(powers) - 1, high - low
    # In u, where x = low + span u.
    moved = [
        span**j * sum(powers[k] * comb(k, j) * low ** (k - j) for k in range(j, n + 1))
        for j in range(n + 1)
    ]
    return [sum(moved[k] * comb(i, k) / comb(n, k) for k in range(i + 1)) for i in range(n + 1)]


@dataclass(frozen=True, slots=True)
class _Box:
    # above, below: coefficients, balls in an array with an axis for each direction.
    above: Balls
    below: Balls
    ends: tuple[tuple[Fraction, Fraction], ...]

    def bound(self) -> Fraction | None:
        """Return what the quotient is not above in the box; None if that is not shown."""
        if not all(a > 0 for a in self.below.flat):
            return None
        ratios: Balls = self.above / self.below
        # Ends of balls have no radius, so that one of two is surely the larger.
        return max(ZERO, fraction_of(max(ratio.upper() for ratio in ratios.flat)))

    def vertices(self) -> Iterator[tuple[Fraction, tuple[Fraction, ...]]]:
        """Yield what the quotient is not below at a vertex, and the vertex."""
        for corner in product((0, -1), repeat=len(self.ends)):
            if self.below[corner] > 0:
                value = fraction_of((self.above[corner] / self.below[corner]).lower())
                yield value, tuple(e[at] for e, at in zip(self.ends, corner, strict=True))

    def halves(self) -> Iterator[_Box]:
        """Yield the halves of the box in the direction in which both polynomials change most."""
        changes = np.max([_changes(values) for values in (self.above, self.below)], axis=0)
        axis = int(changes.argmax())
        low, high = self.ends[axis]
        middle = (low + high) / 2
        parts = zip(_halved(self.above, axis), _halved(self.below, axis), strict=True)
        for (above, below), ends in zip(parts, ((low, middle), (middle, high)), strict=True):
            yield _Box(above, below, (*self.ends[:axis], ends, *self.ends[axis + 1 :]))


def _halved(values: Balls, axis: int) -> tuple[Balls, ...]:
    """Return the coefficients in both halves of a box."""
    line, low, high = [*np.moveaxis(values, axis, 0)], [], []
    while line:
        low.append(line[0])
        high.append(line[-1])
        line = [(a + b) / 2 for a, b in pairwise(line)]
    return np.stack(low, axis), np.stack(high[::-1], axis)


def _changes(values: Balls) -> list[float]:
    """Return how much coefficients differ along each direction, as a share of the largest."""
    numbers = np.array([float(v.mid()) for v in values.flat]).reshape(values.shape)
    largest = np.abs(numbers).max() or 1.0
    return [np.ptp(numbers, axis).max() / largest for axis in range(values.ndim)]


def _as_balls(values: Tensor, shape: Sequence[int]) -> Balls:
    """Return balls around rational numbers, of Python or of flint, at the current precision."""
    from flint import arb

    balls = [ball_around(v) if isinstance(v, Fraction) else arb(v) for v in values]
    return np.array(balls, dtype=object).reshape(shape)
