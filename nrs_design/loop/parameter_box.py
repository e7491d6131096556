"""Boxes of physical parameters: one matrix for each corner, and the check that corners suffice.

A matrix that is affine in each parameter alone (all others held) is, anywhere in the box, a
convex combination of its corners: at ``p = (1-t) low + t high`` along one axis it is ``(1-t)``
times that at the low end plus ``t`` times that at the high end, and so on along the other axes.
The weights are products of such shares: not negative, with sum one, the same for all entries.

Two parameters in which it is affine together may be known to lie in a triangle; then its three
corners suffice, for the same reason. So do the points of a hull, for any number of numbers in which
it is affine together.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, product, starmap
from types import MappingProxyType

from nrs_design.errors import InternalError
from nrs_design.models.interval import Interval

Rows = Sequence[Sequence[Fraction]]
RowsAt = Callable[[Mapping[str, Fraction]], Rows]

# Between the ends of a range, which are labelled as `Interval.ends` does.
MIDDLE = "middle"
_SHARES: Mapping[str, Fraction] = MappingProxyType(
    {"min": Fraction(0), MIDDLE: Fraction(1, 2), "max": Fraction(1)}
)
# Where there is no triangle.
_ANYWHERE = (Fraction(0), Fraction(1))


@dataclass(frozen=True, slots=True)
class Triangle:
    """Where two parameters with ranges lie together."""

    # x, y: in which matrices are affine together. Two corners are the lower ends of both ranges,
    # and the upper ends of both.
    x: str
    y: str
    # The third one, which is called the lower end of x and the upper end of y.
    between: tuple[Fraction, Fraction]


# Points of the space of some numbers, by their symbols.
Points = tuple[Mapping[str, Fraction], ...]
# Between the indices of two points of a hull, whose middle is meant.
_BETWEEN = "~"


def around(ranges: Mapping[str, Interval]) -> Points:
    """Return the points of a simplex that holds a box of numbers: one more than there are numbers.

    With n numbers that have a range, all of them at their low ends, and each of them alone n times
    as far as its high end.
    """
    lowest = {symbol: interval.low for symbol, interval in ranges.items()}
    widths = {s: interval.high - interval.low for s, interval in ranges.items()}
    moved = {symbol: width for symbol, width in widths.items() if width}
    return (lowest, *(lowest | {s: lowest[s] + len(moved) * width} for s, width in moved.items()))


@dataclass(frozen=True, slots=True)
class Box:
    """Where the parameters of a matrix lie."""

    ranges: Mapping[str, Interval]  # By symbols such as ``k`` or ``Mt``; a point adds no corners
    # Parameters in one over which matrices are affine; they are positive. One over such a parameter
    # runs through the interval between the inverse ends, so the corners are the same.
    inverse: frozenset[str] = frozenset()
    # Where two of the parameters are, instead of anywhere in their ranges.
    triangle: Triangle | None = None
    # Points between which other numbers are, in which matrices are affine together.
    hull: Points = ({},)

    def beside(self, other: Box) -> Box:
        """Return the box of the parameters of both, which have no symbol in common."""
        if common := self.ranges.keys() & other.ranges.keys():
            raise InternalError(f"the symbol {min(common)} stands for two parameters")
        if self.triangle and other.triangle:
            raise InternalError("a box of parameters has two triangles")
        if len(self.hull) > 1 and len(other.hull) > 1:
            raise InternalError("a box of parameters has two hulls")
        ranges = {**self.ranges, **other.ranges}
        triangle, hull = self.triangle or other.triangle, max(self.hull, other.hull, key=len)
        return Box(ranges, self.inverse | other.inverse, triangle, hull)

    def middle(self, symbol: str) -> Fraction:
        """Return the value halfway in the coordinate in which matrices are affine."""
        interval = self.ranges[symbol]
        if symbol not in self.inverse:
            return interval.middle
        return 2 / (1 / interval.low + 1 / interval.high)

    def named_values(self, name: str) -> Iterator[tuple[str, dict[str, Fraction]]]:
        """Yield the corners of a mode with their values, the last parameter turning fastest.

        A corner is named after its ends, such as ``a/soft/k-min``, and after the point of the hull,
        such as ``hull-2``; a point has the name of the mode.
        """
        ends = {symbol: dict(interval.ends) for symbol, interval in self.ranges.items()}
        for at in self._points(ends, self._hull_labels()):
            labels = [f"{symbol}-{end}" for symbol, end in zip(ends, at[:-1], strict=True) if end]
            labels += [f"hull-{at[-1]}"] if len(self.hull) > 1 else []
            yield "/".join([name, *labels]), self._at(ends, at)

    def points(self, name: str, attained: Collection[str]) -> Iterator[str]:
        """Yield, for the corners in their order, the names of what they are corners of."""
        symbols = [*self.ranges]
        ends = {symbol: dict(interval.ends) for symbol, interval in self.ranges.items()}
        for at in self._points(ends, self._hull_labels()):
            pairs = zip(symbols, at[:-1], strict=True)
            yield "/".join([name, *(f"{s}-{end}" for s, end in pairs if end and s in attained)])

    def corners(self, rows_at: RowsAt, name: str) -> Iterator[tuple[str, Rows]]:
        """Yield the corners of a mode with their matrices, the last parameter turning fastest.

        Named as in `named_values`. An `InternalError` if the matrix is not affine along each axis.
        """
        found = [(corner, rows_at(values)) for corner, values in self.named_values(name)]
        ends = {symbol: dict(interval.ends) for symbol, interval in self.ranges.items()}
        rows = (rows for _, rows in found)
        points = self._points(ends, self._hull_labels())
        self._check_corners_suffice(rows_at, dict(zip(points, rows, strict=True)), name)
        yield from found

    def _check_corners_suffice(
        self, rows_at: RowsAt, corners: Mapping[tuple[str, ...], Rows], name: str
    ) -> None:
        """Check exactly that a matrix is affine along each axis, the others being held.

        That it is, follows from the formulas of the loop. It is computed again because a proof for
        the whole box rests on it: on all points of the grid of low end, middle and high end of
        every axis, the matrix must be the mean of its two neighbors along one axis on which it is
        in the middle; so it is the mean of the corners around it. For entries of a degree of at
        most two in each coordinate, and in those of a triangle or a hull together, this decides it:
        of these, the grid has the corners and the middles between any two.
        """
        known = dict(corners)
        values = {symbol: self._grid(symbol) for symbol in self.ranges}
        pairs = combinations(self._hull_labels(), 2)
        hull = [*self._hull_labels(), *map(_BETWEEN.join, pairs)]
        # Rows that are the same objects are compared once; kept here, no other gets their ids.
        compared: dict[tuple[int, ...], tuple[Sequence[Fraction], ...]] = {}
        # Neighbors are in the middle on one axis less, so they come first.
        for at in sorted(self._points(values, hull), key=_count_middles):
            if not _count_middles(at):
                continue
            low, high = (known[beside] for beside in self._beside(at))
            found = known[at] = rows_at(self._at(values, at))
            triples = {tuple(map(id, rows)): rows for rows in zip(found, low, high, strict=True)}
            if not all(_is_mean(*triples[key]) for key in triples.keys() - compared.keys()):
                raise InternalError(f"the matrix of mode {name} is not affine in each parameter")
            compared |= triples

    def _hull_labels(self) -> list[str]:
        return [*map(str, range(len(self.hull)))]

    def _points(
        self, values: Mapping[str, Mapping[str, Fraction]], hull: Sequence[str]
    ) -> Iterator[tuple[str, ...]]:
        """Yield the labels of the points of a grid, of a triangle those in it; the hull's last."""
        for at in product(*values.values(), hull):
            x, y = self._shares(at)
            if x <= y:
                yield at

    def _at(
        self, values: Mapping[str, Mapping[str, Fraction]], at: Sequence[str]
    ) -> dict[str, Fraction]:
        """Return the values of all symbols where the labels of a point say."""
        labels = zip(values, at[:-1], strict=True)
        found = {symbol: values[symbol][label] for symbol, label in labels}
        ends = [self.hull[int(label)] for label in at[-1].split(_BETWEEN)]
        found |= {s: sum((end[s] for end in ends), Fraction(0)) / len(ends) for s in ends[0]}
        if self.triangle is not None:
            x, y = self._shares(at)
            both = (self.triangle.x, self.triangle.y)
            for symbol, between in zip(both, self.triangle.between, strict=True):
                low, high = self.ranges[symbol].low, self.ranges[symbol].high
                found[symbol] = low + y * (between - low) + x * (high - between)
        return found

    def _beside(self, at: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
        """Yield the two neighbors of a point in the middle; across a triangle, along both axes."""
        if _BETWEEN in at[-1]:
            yield from ((*at[:-1], end) for end in at[-1].split(_BETWEEN))
            return
        axes = self._triangle_axes()
        across = axes and all(at[i] == MIDDLE for i in axes)
        moved = axes if across else (at.index(MIDDLE),)
        for end in ("min", "max"):
            yield tuple(end if i in moved else label for i, label in enumerate(at))

    def _shares(self, at: Sequence[str]) -> tuple[Fraction, Fraction]:
        """Return how far a point is on the way from the third corner, and on that to it."""
        axes = self._triangle_axes()
        return (_SHARES[at[axes[0]]], _SHARES[at[axes[1]]]) if axes else _ANYWHERE

    def _triangle_axes(self) -> tuple[int, ...]:
        symbols = [*self.ranges]
        both = () if self.triangle is None else (self.triangle.x, self.triangle.y)
        return tuple(symbols.index(symbol) for symbol in both)

    def _grid(self, symbol: str) -> dict[str, Fraction]:
        """Return the labelled ends of a range, and the middle between two."""
        ends = dict(self.ranges[symbol].ends)
        return ends | ({MIDDLE: self.middle(symbol)} if len(ends) > 1 else {})


def _count_middles(at: Sequence[str]) -> int:
    return at.count(MIDDLE) + (_BETWEEN in at[-1])


def _is_mean(row: Sequence[Fraction], a: Sequence[Fraction], b: Sequence[Fraction]) -> bool:
    """Tell whether a row is the mean of two; most rows do not change at all along an axis."""
    return row == a == b or all(starmap(_is_middle, zip(row, a, b, strict=True)))


def _is_middle(entry: Fraction, x: Fraction, y: Fraction) -> bool:
    """Tell whether an entry is halfway between two, without reducing fractions on the way."""
    # Most entries are one zero.
    if entry is x is y:
        return True
    (n, d), (p, q), (r, s) = (number.as_integer_ratio() for number in (entry, x, y))
    return 2 * n * q * s == (p * s + r * q) * d
