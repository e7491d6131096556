"""Boxes of physical parameters: one matrix for each corner, and the check that corners suffice.

A matrix that is affine in each parameter alone (all others held) is, anywhere in the box, a
convex combination of its corners: at ``p = (1-t) low + t high`` along one axis it is ``(1-t)``
times that at the low end plus ``t`` times that at the high end, and so on along the other axes.
The weights are products of such shares: not negative, with sum one, the same for all entries.

Two parameters in which it is affine together may be known to lie above the chord between both
ends; then the triangle of the ends and the corner above the chord suffices, for the same reason.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product, starmap

from nrs_design.errors import InternalError
from nrs_design.proof.noun import dataclass
from nrs_design.spec.interval import Interval

Rows = Sequence[Sequence[Fraction]]
RowsAt = Callable[[Mapping[str, Fraction]], Rows]

# Between the ends of a range, which are labelled as `Interval.ends` does.
MIDDLE = "middle"


@dataclass(frozen=True, slots=True)
class Box:
    """Where the parameters of a matrix lie.

    Parameters
    ----------
    ranges : mapping of str to Interval
        By symbols such as ``k`` or ``Mt``; a point adds no corners.
    inverse : frozenset of str
        Parameters in one over which matrices are affine; they are positive. One over such a
        parameter runs through the interval between the inverse ends, so the corners are the same.
    chord : tuple of str, optional
        Two parameters x and y in which matrices are affine together, with ``(x, y)`` never below
        the line from ``(x.low, y.low)`` to ``(x.high, y.high)``: the corner below it is none.
    """

    ranges: Mapping[str, Interval]
    inverse: frozenset[str] = frozenset()
    chord: tuple[str, str] | None = None

    def beside(self, other: Box) -> Box:
        """Return the box of the parameters of both.

        Raises
        ------
        InternalError
            If a symbol stands for two parameters, or both have a chord.
        """
        if common := self.ranges.keys() & other.ranges.keys():
            raise InternalError(f"the symbol {min(common)} stands for two parameters")
        if self.chord and other.chord:
            raise InternalError("a box of parameters has two chords")
        ranges = {**self.ranges, **other.ranges}
        return Box(ranges, self.inverse | other.inverse, self.chord or other.chord)

    def middle(self, symbol: str) -> Fraction:
        """Return the value halfway in the coordinate in which matrices are affine."""
        interval = self.ranges[symbol]
        if symbol not in self.inverse:
            return interval.middle
        return 2 / (1 / interval.low + 1 / interval.high)

    def values(self) -> Iterator[dict[str, Fraction]]:
        """Yield the values of the parameters at every corner, the last one turning fastest."""
        values = {symbol: dict(interval.ends) for symbol, interval in self.ranges.items()}
        for at in self._points(values):
            yield _values(values, at)

    def corners(self, rows_at: RowsAt, name: str) -> Iterator[tuple[str, Rows]]:
        """Yield the corners, the last parameter turning fastest.

        Parameters
        ----------
        rows_at : callable
            Gives the matrix for the values of the parameters by their symbols.
        name : str
            Of the mode whose corners they are.

        Yields
        ------
        tuple of str and rows
            The name, such as ``a/soft/k-min/Mt-max`` (that of the mode for a point), and the
            matrix.

        Raises
        ------
        InternalError
            If the matrix is not affine along each axis.
        """
        values = {symbol: dict(interval.ends) for symbol, interval in self.ranges.items()}
        corners = {at: rows_at(_values(values, at)) for at in self._points(values)}
        self._check_corners_suffice(rows_at, corners, name)
        for at, rows in corners.items():
            pairs = zip(values, at, strict=True)
            yield "/".join([name, *(f"{symbol}-{end}" for symbol, end in pairs if end)]), rows

    def _check_corners_suffice(
        self, rows_at: RowsAt, corners: Mapping[tuple[str, ...], Rows], name: str
    ) -> None:
        """Check exactly that a matrix is affine along each axis, the others being held.

        That it is, follows from the formulas of the loop. It is computed again because a proof for
        the whole box rests on it: on all points of the grid of low end, middle and high end of
        every axis, the matrix must be the mean of its two neighbors along one axis on which it is
        in the middle; so it is the mean of the corners around it. For entries of a degree of at
        most two in each coordinate, and in both of a chord, this decides it: of a triangle, the
        grid has the corners and the middles of the sides.
        """
        known = dict(corners)
        values = {symbol: self._grid(symbol) for symbol in self.ranges}
        # Rows that are the same objects are compared once; kept here, no other gets their ids.
        compared: dict[tuple[int, ...], tuple[Sequence[Fraction], ...]] = {}
        # Neighbors are in the middle on one axis less, so they come first.
        for at in sorted(self._points(values), key=lambda at: at.count(MIDDLE)):
            if MIDDLE not in at:
                continue
            moved = self._moved(at)
            low, high = (
                known[tuple(end if i in moved else label for i, label in enumerate(at))]
                for end in ("min", "max")
            )
            found = known[at] = rows_at(_values(values, at))
            triples = {tuple(map(id, rows)): rows for rows in zip(found, low, high, strict=True)}
            if not all(_is_mean(*triples[key]) for key in triples.keys() - compared.keys()):
                raise InternalError(f"the matrix of mode {name} is not affine in each parameter")
            compared |= triples

    def _points(self, values: Mapping[str, Mapping[str, Fraction]]) -> Iterator[tuple[str, ...]]:
        """Yield the labels of the points of a grid that are not below the chord."""
        for at in product(*values.values()):
            if self.chord is None or not _is_below(*(at[i] for i in self._chord_axes())):
                yield at

    def _moved(self, at: Sequence[str]) -> set[int]:
        """Return along which axes a point has its two neighbors; in the middle of a chord, both."""
        if self.chord is not None and all(at[i] == MIDDLE for i in self._chord_axes()):
            return {*self._chord_axes()}
        return {at.index(MIDDLE)}

    def _chord_axes(self) -> Iterator[int]:
        symbols = [*self.ranges]
        return (symbols.index(symbol) for symbol in self.chord or ())

    def _grid(self, symbol: str) -> dict[str, Fraction]:
        """Return the labelled ends of a range, and the middle between two."""
        ends = dict(self.ranges[symbol].ends)
        return ends | ({MIDDLE: self.middle(symbol)} if len(ends) > 1 else {})


def _is_below(x: str, y: str) -> bool:
    """Tell whether a point is below the chord by its labels; those of a point are empty."""
    order = ("", "min", MIDDLE, "max")
    return bool(x and y) and order.index(x) > order.index(y)


def _values(values: Mapping[str, Mapping[str, Fraction]], at: Sequence[str]) -> dict[str, Fraction]:
    """Return the values of all symbols where the labels of a point say."""
    return {symbol: values[symbol][label] for symbol, label in zip(values, at, strict=True)}


def _is_mean(row: Sequence[Fraction], a: Sequence[Fraction], b: Sequence[Fraction]) -> bool:
    """Tell whether a row is the mean of two; most rows do not change at all along an axis."""
    return row == a == b or all(starmap(_is_middle, zip(row, a, b, strict=True)))


def _is_middle(entry: Fraction, x: Fraction, y: Fraction) -> bool:
    """Tell whether an entry is halfway between two, without reducing fractions on the way."""
    (n, d), (p, q), (r, s) = (number.as_integer_ratio() for number in (entry, x, y))
    return 2 * n * q * s == (p * s + r * q) * d
