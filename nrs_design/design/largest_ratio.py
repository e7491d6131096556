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

from nrs_design.proof.enclosure import ball_around, fraction_of, precision

# Between the two bounds, as a share of the lower one.
NEARLY = Fraction(1, 400)
# Coefficients that are looked at before the search ends.
MOST = 400_000
ZERO, ONE = Fraction(0), Fraction(1)

Tensor = Sequence[Any]  # Rational numbers or balls, the last index turning fastest


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
    each direction. The bounds are drawn closer until it is decided whether the quotient stays below
    a limit, or until they are as near as a share; what is not shown by `most` coefficients is not
    shown.
    """
    with precision():
        return _search(
            _as_balls(numerator), _as_balls(denominator), tuple(shape), limit, nearly, most
        )


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
    above: Any
    below: Any
    shape: tuple[int, ...]
    ends: tuple[tuple[Fraction, Fraction], ...]

    def bound(self) -> Fraction | None:
        """Return what the quotient is not above in the box; None if that is not shown."""
        if not all(a > 0 for a in self.below):
            return None
        ratios = ((a / b).upper() for a, b in zip(self.above, self.below, strict=True))
        # Ends of balls have no radius, so that one of two is surely the larger.
        return max(ZERO, fraction_of(max(ratios)))

    def vertices(self) -> Iterator[tuple[Fraction, tuple[Fraction, ...]]]:
        """Yield what the quotient is not below at a vertex, and the vertex."""
        for corner in product((0, 1), repeat=len(self.shape)):
            place = 0
            for at, n in zip(corner, self.shape, strict=True):
                place = place * n + at * (n - 1)
            if self.below[place] > 0:
                value = _lower(self.above[place] / self.below[place])
                yield value, tuple(e[at] for e, at in zip(self.ends, corner, strict=True))

    def halves(self, axis: int) -> tuple[_Box, _Box]:
        """Halve the box in one direction."""
        low, high = self.ends[axis]
        middle = (low + high) / 2
        above, below = (_halved(values, self.shape, axis) for values in (self.above, self.below))
        first, last = (
            (*self.ends[:axis], ends, *self.ends[axis + 1 :])
            for ends in ((low, middle), (middle, high))
        )
        return (
            _Box(above[0], below[0], self.shape, first),
            _Box(above[1], below[1], self.shape, last),
        )

    def widest(self) -> int:
        """Return the direction in which both polynomials change most."""
        changes = [
            max(_change(values, self.shape, axis) for values in (self.above, self.below))
            for axis in range(len(self.shape))
        ]
        return changes.index(max(changes))


def _search(
    above: Tensor,
    below: Tensor,
    shape: tuple[int, ...],
    limit: Fraction | None,
    nearly: Fraction | None,
    most: int,
) -> LargestRatio:
    """Halve the box with the highest bound until the bounds meet."""
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

    take(_Box(above, below, shape, tuple((ZERO, ONE) for _ in shape)))
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
        for half in box.halves(box.widest()):
            take(half)
            spent += size


def _halved(values: Tensor, shape: tuple[int, ...], axis: int) -> tuple[list[Any], list[Any]]:
    """Return the coefficients in both halves of a box."""
    n, step = shape[axis], prod(shape[axis + 1 :])
    low, high = list(values), list(values)
    for start in _starts(shape, axis):
        places = range(start, start + n * step, step)
        line = [values[i] for i in places]
        for k in range(n):
            low[places[k]], high[places[n - 1 - k]] = line[0], line[-1]
            line = [(a + b) / 2 for a, b in pairwise(line)]
    return low, high


def _change(values: Tensor, shape: tuple[int, ...], axis: int) -> float:
    """Return how much coefficients differ along a direction, as a share of the largest."""
    n, step = shape[axis], prod(shape[axis + 1 :])
    numbers = [float(v.mid()) for v in values]
    largest = max(map(abs, numbers)) or 1.0
    lines = (numbers[i : i + n * step : step] for i in _starts(shape, axis))
    return max(max(line) - min(line) for line in lines) / largest


def _starts(shape: tuple[int, ...], axis: int) -> Iterator[int]:
    n, step = shape[axis], prod(shape[axis + 1 :])
    for before in range(prod(shape[:axis])):
        yield from range(before * n * step, before * n * step + step)


def _as_balls(values: Tensor) -> list[Any]:
    """Return balls around rational numbers, of Python or of flint, at the current precision."""
    from flint import arb

    return [ball_around(v) if isinstance(v, Fraction) else arb(v) for v in values]


def _lower(ball: Any) -> Fraction:
    return fraction_of(ball.lower())
