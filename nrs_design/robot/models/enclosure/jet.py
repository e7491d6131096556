"""Taylor series in the three coordinates of a pose, which enclose a function over boxes of poses.

A jet knows the coefficients of a function at the middle of each box, and balls that contain those
at every point of the box. Of a product, the latter are computed for the highest order; those below
follow by the mean value theorem, from the middle and from the next order. So what a quantity is off
by shrinks with as high a power of the size of a box as the jet has orders, and not with the first,
as in interval arithmetic. Coefficients that vanish everywhere are left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from itertools import product
from typing import TypeAlias

import numpy as np

from nrs_design.robot.models.enclosure.balls import OUTWARD, TINY, Balls, Floats

MAX_ORDER = 5
_POWERS = sorted((p for p in product(range(6), repeat=3) if sum(p) <= MAX_ORDER), key=sum)
_DEGREE = [sum(p) for p in _POWERS]
_INDEX = {p: i for i, p in enumerate(_POWERS)}
_SUM = [
    [_INDEX.get(tuple(a + b for a, b in zip(p, q, strict=True)), -1) for q in _POWERS]
    for p in _POWERS
]
# For each place: which other one makes it up, with which.
_REST = [
    {i: j for i, row in enumerate(_SUM) for j, k in enumerate(row) if k == m}
    for m in range(len(_POWERS))
]
_UNITS = [_INDEX[1, 0, 0], _INDEX[0, 1, 0], _INDEX[0, 0, 1]]
Terms: TypeAlias = dict[int, Balls]


def _neighbours(step: int) -> list[list[tuple[int, int, int]]]:
    """For each coordinate: place of a power, of that with a step more, and the larger exponent."""
    rows = []
    for k in range(3):
        moved = ((i, (*p[:k], p[k] + step, *p[k + 1 :])) for i, p in enumerate(_POWERS))
        rows.append([(i, _INDEX[q], max(_POWERS[i][k], q[k])) for i, q in moved if q in _INDEX])
    return rows


_DERIVED = _neighbours(-1)
_RISEN = [{i: (j, f) for i, j, f in row} for row in _neighbours(1)]


def degree(place: int) -> int:
    """Return the order of the derivative that a coefficient belongs to."""
    return _DEGREE[place]


class Jet:
    """A function over boxes.

    Parameters
    ----------
    order : int
        Up to which coefficients are known, at most `MAX_ORDER`.
    half : sequence of array
        Half the width of the boxes in each coordinate.
    middle, whole : dict
        Coefficients by the place of their powers, at the middle of each box and all over it.
    """

    __slots__ = ("half", "middle", "order", "whole")

    def __init__(self, order: int, half: Sequence[Floats], middle: Terms, whole: Terms) -> None:
        self.order = order
        self.half = half
        self.middle = middle
        self.whole = whole

    def constant(self, value: Balls) -> Jet:
        """Return a constant over the same boxes."""
        return Jet(self.order, self.half, {0: value}, {0: value})

    def zero(self) -> Jet:
        """Return the function that vanishes."""
        return Jet(self.order, self.half, {}, {})

    def __add__(self, other: Jet | Balls | float) -> Jet:
        """Return the sum, known to the lower of both orders."""
        if not isinstance(other, Jet):
            parts = ({**t, 0: t[0] + other if 0 in t else Balls(0.0) + other} for t in self._both)
            return Jet(self.order, self.half, *parts)
        order = min(self.order, other.order)
        parts = (_added(a, b, order) for a, b in zip(self._both, other._both, strict=True))
        return Jet(order, self.half, *parts)

    def __neg__(self) -> Jet:
        """Return the opposite."""
        return Jet(self.order, self.half, *({i: -a for i, a in t.items()} for t in self._both))

    def __sub__(self, other: Jet | Balls | float) -> Jet:
        """Return the difference."""
        return self + (-other)

    def __mul__(self, other: Jet | Balls | float) -> Jet:
        """Return the product, known to the lower of both orders."""
        if not isinstance(other, Jet):
            parts = ({i: a * other for i, a in t.items()} for t in self._both)
            return Jet(self.order, self.half, *parts)
        order = min(self.order, other.order)
        middle = _product(self.middle, other.middle, order, 0)
        return self._enclosed(order, middle, _product(self.whole, other.whole, order, order))

    __radd__ = __add__
    __rmul__ = __mul__

    @property
    def _both(self) -> tuple[Terms, Terms]:
        return self.middle, self.whole

    @property
    def value(self) -> Balls:
        """The function itself, all over each box."""
        return self.whole.get(0, Balls(0.0))

    def change(self, k: int) -> Floats | float:
        """Return by how much it changes at most from the middle across a coordinate."""
        slope = self.whole.get(_UNITS[k])
        return 0.0 if slope is None else slope.magnitude * self.half[k]

    def derivative(self, k: int) -> Jet:
        """Return the derivative with respect to the k-th coordinate, known to one order less."""
        parts = ({j: t[i] * f for i, j, f in _DERIVED[k] if i in t} for t in self._both)
        return Jet(self.order - 1, self.half, *parts)

    def gradient(self) -> list[Jet]:
        """Return the derivatives with respect to all three coordinates."""
        return [self.derivative(k) for k in range(3)]

    def sqrt(self) -> Jet:
        """Return the root; where it is not above zero, its terms are not finite."""

        def series(value: Balls) -> list[Balls]:
            root, inverse = value.sqrt(), value.reciprocal()
            terms = [root]
            for k in range(self.order):
                terms.append(terms[-1] * inverse * (0.5 - k) * _share(k + 1))
            return terms

        return self._compose(series)

    def reciprocal(self) -> Jet:
        """Return one over it; where zero is in a box, its terms are not finite."""

        def series(value: Balls) -> list[Balls]:
            terms = [value.reciprocal()]
            for _ in range(self.order):
                terms.append(-(terms[-1] * terms[0]))
            return terms

        return self._compose(series)

    def _compose(self, series: Callable[[Balls], list[Balls]]) -> Jet:
        """Return the function whose Taylor coefficients at a value are given, of this one."""
        middle, whole = (_composed(t, series(t[0]), self.order) for t in self._both)
        return self._enclosed(self.order, middle, whole)

    def _enclosed(self, order: int, middle: Terms, highest: Terms) -> Jet:
        """Return the jet whose coefficients below the order follow from those above."""
        whole = {i: a for i, a in highest.items() if _DEGREE[i] == order}
        for i in sorted(middle, reverse=True):
            if _DEGREE[i] == order:
                continue
            rad = middle[i].rad
            for k in range(3):
                j, factor = _RISEN[k][i]
                if j in whole:
                    rad = rad + whole[j].magnitude * (self.half[k] * factor)
            whole[i] = Balls(middle[i].mid, rad * OUTWARD + TINY)
        return Jet(order, self.half, middle, whole)


def coordinate_jets(middle: Sequence[Floats], half: Sequence[Floats], order: int) -> list[Jet]:
    """Return the three coordinates themselves.

    Parameters
    ----------
    middle, half : sequence of array
        Of the boxes, in each coordinate.
    order : int
        At least 1.
    """
    one = Balls(1.0)
    return [
        Jet(order, half, {0: Balls(m), unit: one}, {0: Balls(m, h), unit: one})
        for m, h, unit in zip(middle, half, _UNITS, strict=True)
    ]


def direction_jets(slopes: Sequence[Jet], cos: Balls, sin: Balls) -> tuple[Jet, Jet]:
    """Return cosine and sine of an angle, of one order more than its derivatives.

    Parameters
    ----------
    slopes : sequence of Jet
        The derivatives of the angle with respect to the three coordinates.
    cos, sin : Balls
        Of the angle in the middle of each box.
    """
    first, half = slopes[0], slopes[0].half
    order = first.order + 1
    turn = sum((p.value.magnitude * h for p, h in zip(slopes, half, strict=True)), 0.0)
    # While the angle turns by t, the cosine goes at most |sin| t + t^2/2, and the sine likewise.
    ends = [
        Balls(part.mid, (part.rad + (other.magnitude + turn) * turn) * OUTWARD + TINY)
        for part, other in ((cos, sin), (sin, cos))
    ]
    starts = [(cos, sin), (ends[0], ends[1])]
    parts = [
        _rotated([getattr(p, name) for p in slopes], c, s, order)
        for name, (c, s) in zip(("middle", "whole"), starts, strict=True)
    ]
    even, odd = (Jet(order, half, parts[0][i], parts[1][i]) for i in range(2))
    return (
        even._enclosed(order, even.middle, even.whole),
        odd._enclosed(order, odd.middle, odd.whole),
    )


def _rotated(slopes: Sequence[Terms], cos: Balls, sin: Balls, order: int) -> tuple[Terms, Terms]:
    """Integrate ``cos' = -sin angle'`` and ``sin' = cos angle'``, one order after the other."""
    c, s = {0: cos}, {0: sin}
    for i, powers in enumerate(_POWERS):
        if not 0 < _DEGREE[i] <= order:
            continue
        k = next(k for k in range(3) if powers[k] and (slopes[k] or powers[k] == sum(powers)))
        j, factor = next((j, f) for a, j, f in _DERIVED[k] if a == i)
        if (of_sin := _coefficient(s, slopes[k], j)) is not None:
            c[i] = of_sin * -_share(factor)
        if (of_cos := _coefficient(c, slopes[k], j)) is not None:
            s[i] = of_cos * _share(factor)
    return c, s


@cache
def _share(count: int) -> Balls:
    """Return one of so many equal parts of 1: no float is a third."""
    return Balls(np.float64(count)).reciprocal()


def _coefficient(left: Terms, right: Terms, wanted: int) -> Balls | None:
    """Return one coefficient of a product; None where it vanishes."""
    total = None
    for i, a in left.items():
        j = _REST[wanted].get(i)
        if j is not None and j in right:
            total = a * right[j] if total is None else total + a * right[j]
    return total


def _added(left: Terms, right: Terms, order: int) -> Terms:
    terms = {i: a for i, a in left.items() if _DEGREE[i] <= order}
    for i, b in right.items():
        if _DEGREE[i] <= order:
            terms[i] = terms[i] + b if i in terms else b
    return terms


def _product(left: Terms, right: Terms, highest: int, lowest: int) -> Terms:
    """Multiply two series; only orders from the lowest to the highest are wanted."""
    terms: Terms = {}
    for i, a in left.items():
        for j, b in right.items():
            if lowest <= _DEGREE[i] + _DEGREE[j] <= highest:
                k = _SUM[i][j]
                terms[k] = terms[k] + a * b if k in terms else a * b
    return terms


def _composed(inner: Terms, series: Sequence[Balls], order: int) -> Terms:
    step = {i: a for i, a in inner.items() if i}
    result: Terms = {0: series[order]}
    for coefficient in reversed(series[:order]):
        result = _product(result, step, order, 0)
        result[0] = result[0] + coefficient if 0 in result else coefficient
    return result
