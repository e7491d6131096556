"""A bound on the quotient of two polynomials over a box, by exact enclosures.

In Bernstein form, the value of a polynomial anywhere in a box is a mean of its coefficients, all
weights being positive. So where every coefficient of the denominator is positive, the quotient is
nowhere above the largest quotient of two coefficients (Narkawicz, Garloff, Smith, Munoz 2012,
"Bounding the range of a rational function over a box"). At the vertices the coefficients are the
values, which bounds the largest quotient from below. Halves of a box have coefficients that are
means of those before (de Casteljau). Coefficients are balls: what is said of them is said of every
number in them.
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

# Coefficients that are looked at before the search ends.
MAX_PIECES = 40_000
ZERO = Fraction(0)

Tensor = Sequence[Any]  # Rational numbers or balls, the last index turning fastest
Balls = NDArray[Any]  # The same, an axis for each direction


def bound_ratio(
    numerator: Tensor,
    denominator: Tensor,
    shape: Sequence[int],
    limit: Fraction | None = None,
    max_pieces: int = MAX_PIECES,
) -> Fraction | None:
    """Return an upper bound on a quotient of polynomials in the unit box; None without one.

    Neither is negative in the box; Bernstein coefficients come in the order of indices, so many in
    each direction. The box with the highest bound is halved until the quotient has a bound, and
    one below the limit, if there is a limit and the quotient does not exceed it.
    """
    order, spent, size, lower_bound = count(), 0, prod(shape), ZERO
    boxes: list[tuple[bool, Fraction, int, _Box]] = []

    def take(box: _Box) -> None:
        nonlocal lower_bound
        lower_bound = max(lower_bound, *box.values())
        bound = box.bound()
        # Those without a bound first, then the highest.
        heappush(boxes, (bound is not None, -(bound or ZERO), next(order), box))

    with precision():
        take(_Box(_as_balls(numerator, shape), _as_balls(denominator, shape)))
        while True:
            bounded, negative, _, box = boxes[0]
            exceeded = limit is not None and lower_bound > limit
            is_within = bounded and (limit is None or -negative <= limit)
            if is_within or exceeded or spent > max_pieces:
                return -negative if bounded else None
            heappop(boxes)
            for half in box.halves():
                take(half)
                spent += size


def bernstein(powers: Tensor, low: Any, high: Any) -> list[Any]:
    """Return Bernstein coefficients between two numbers, of powers from the lowest on."""
    n, span = len(powers) - 1, high - low
    # In u, where x = low + span u.
    shifted = [
        span**j * sum(powers[k] * comb(k, j) * low ** (k - j) for k in range(j, n + 1))
        for j in range(n + 1)
    ]
    return [sum(shifted[k] * comb(i, k) / comb(n, k) for k in range(i + 1)) for i in range(n + 1)]


@dataclass(frozen=True, slots=True)
class _Box:
    # above, below: coefficients, balls in an array with an axis for each direction.
    numerator: Balls
    denominator: Balls

    def bound(self) -> Fraction | None:
        """Return an upper bound on the quotient in the box; None without one."""
        if not all(a > 0 for a in self.denominator.flat):
            return None
        ratios: Balls = self.numerator / self.denominator
        # Ends of balls have no radius, so that one of two is surely the larger.
        return max(ZERO, fraction_of(max(ratio.upper() for ratio in ratios.flat)))

    def values(self) -> Iterator[Fraction]:
        """Yield zero, and a lower bound on the quotient at each vertex."""
        yield ZERO
        for corner in product((0, -1), repeat=self.denominator.ndim):
            if self.denominator[corner] > 0:
                yield fraction_of((self.numerator[corner] / self.denominator[corner]).lower())

    def halves(self) -> Iterator[_Box]:
        """Yield the halves of the box in the direction in which both polynomials change most."""
        changes = np.max(
            [_changes(values) for values in (self.numerator, self.denominator)], axis=0
        )
        axis = int(changes.argmax())
        for parts in zip(_halve(self.numerator, axis), _halve(self.denominator, axis), strict=True):
            yield _Box(*parts)


def _halve(values: Balls, axis: int) -> tuple[Balls, ...]:
    """Return the coefficients in both halves of a box."""
    line, low, high = [*np.moveaxis(values, axis, 0)], [], []
    while line:
        low.append(line[0])
        high.append(line[-1])
        line = [(a + b) / 2 for a, b in pairwise(line)]
    return np.stack(low, axis), np.stack(high[::-1], axis)


def _changes(values: Balls) -> list[float]:
    """Return the spread of coefficients along each direction, relative to the largest."""
    numbers = np.array([float(v.mid()) for v in values.flat]).reshape(values.shape)
    largest = np.abs(numbers).max() or 1.0
    return [np.ptp(numbers, axis).max() / largest for axis in range(values.ndim)]


def _as_balls(values: Tensor, shape: Sequence[int]) -> Balls:
    """Return balls around rational numbers, of Python or of flint, at the current precision."""
    from flint import arb

    balls = [ball_around(v) if isinstance(v, Fraction) else arb(v) for v in values]
    return np.array(balls, dtype=object).reshape(shape)
