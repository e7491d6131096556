"""Boxes of physical parameters: one matrix for each corner, and the check that corners suffice.

A matrix that is affine in each parameter alone (all others held) is, anywhere in the box, a
convex combination of its corners: at ``p = (1-t) low + t high`` along one axis it is ``(1-t)``
times that at the low end plus ``t`` times that at the high end, and so on along the other axes.
The weights are products of such shares: not negative, with sum one, the same for all entries.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

from nrs_design.errors import InternalError
from nrs_design.models.interval import Interval

Rows = Sequence[Sequence[Fraction]]
RowsAt = Callable[[Mapping[str, Fraction]], Rows]


@dataclass(frozen=True, slots=True)
class Axis:
    """One parameter of a box.

    Parameters
    ----------
    symbol : str
        Such as ``k`` or ``Mt``.
    interval : Interval
        Where it lies; a point adds no corners.
    inverse : bool
        Whether matrices are affine in one over the parameter; then it is positive. One over it
        runs through the interval between the inverse ends, so the corners are the same.
    """

    symbol: str
    interval: Interval
    inverse: bool = False

    @property
    def middle(self) -> Fraction:
        """The value halfway in the coordinate in which matrices are affine."""
        if not self.inverse:
            return self.interval.middle
        return 2 / (1 / self.interval.low + 1 / self.interval.high)


def box_corners(axes: Sequence[Axis], rows_at: RowsAt, name: str) -> Iterator[tuple[str, Rows]]:
    """Yield the corners of a box, the last axis turning fastest.

    Parameters
    ----------
    axes : sequence of Axis
        Every parameter that the matrix depends on.
    rows_at : callable
        Gives the matrix for the values of the parameters by their symbols.
    name : str
        Of the mode, for errors.

    Yields
    ------
    tuple of str and rows
        The label, such as ``k-min/Mt-max`` (empty for a point), and the matrix.

    Raises
    ------
    InternalError
        If the matrix is not affine along each axis.
    """
    labels, corners = [], {}
    for ends in product(*(axis.interval.ends for axis in axes)):
        values = {axis.symbol: value for axis, (_, value) in zip(axes, ends, strict=True)}
        pairs = zip(axes, ends, strict=True)
        labels.append("/".join(f"{axis.symbol}-{end}" for axis, (end, _) in pairs if end))
        corners[tuple(values.values())] = rows_at(values)
    check_corners_suffice(axes, rows_at, corners, name)
    yield from zip(labels, corners.values(), strict=True)


def check_corners_suffice(
    axes: Sequence[Axis], rows_at: RowsAt, corners: Mapping[tuple[Fraction, ...], Rows], name: str
) -> None:
    """Check exactly that a matrix is affine along each axis, the others being held.

    That it is, follows from the formulas of the loop. It is computed again because a proof for
    the whole box rests on it: on all points of the grid of low end, middle and high end of every
    axis, the matrix must be the mean of the corners around it. For entries of a degree of at most
    two in each coordinate this decides it.

    Parameters
    ----------
    axes, rows_at, name
        As for `box_corners`.
    corners : mapping
        The matrix at each corner, by the values of the parameters in the order of the axes.

    Raises
    ------
    InternalError
        If it is not.
    """
    for around in product(*(_neighbors(axis) for axis in axes)):
        point = [
            values[0] if len(values) == 1 else a.middle
            for a, values in zip(axes, around, strict=True)
        ]
        ends = [corners[key] for key in product(*around)]
        if len(ends) == 1:
            continue
        found = rows_at({axis.symbol: value for axis, value in zip(axes, point, strict=True)})
        n = range(len(found))
        if any(found[i][j] * len(ends) != sum(e[i][j] for e in ends) for i in n for j in n):
            raise InternalError(f"the matrix of mode {name} is not affine in each parameter")


def _neighbors(axis: Axis) -> list[tuple[Fraction, ...]]:
    """Return each end, and if they differ both for the middle between them."""
    ends = tuple(value for _, value in axis.interval.ends)
    return [(end,) for end in ends] + ([ends] if len(ends) > 1 else [])
