"""Intervals that a reader looks for in a map: of this environment, of others, and of their own."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted
from nrs_design.spec import parse_exact
from nrs_design.spec.document import Mapping, Node, Scalar
from nrs_design.spec.document import Sequence as Items
from nrs_design.spec.edits import node_at
from nrs_design.spec.exact import is_number
from nrs_design.sweeps.tiles import TileCut, TileField, TileGrid

_MARK = re.compile(r"\s*([^=]+?)\s*=\s*([^\s.]\S*?)\.\.(\S+)(?:\s+(\S.*?))?\s*")
EXAMPLE = "write NAME=LOW..HIGH UNIT, such as 'hand=434..1570 N/m'"


@dataclass(frozen=True, slots=True)
class Mark:
    """An interval along a field, with what it is of."""

    axis: int  # Which field
    name: str
    low: float  # In the unit of the field
    high: float


def declared_marks(grid: TileGrid) -> tuple[Mark, ...]:
    """Return the ranges that the spec declares along fields that are cut into intervals.

    Of a field of an environment, those of the others count, too, where they have the same unit.

    Parameters
    ----------
    grid : TileGrid
        The tiles.
    """
    marks = []
    for axis, field in enumerate(grid.fields):
        at = field.field.at
        if field.cut is not TileCut.INTERVAL:
            continue
        places = [(str(at[-1]), at)]
        if at[0] == "environments" and len(at) == 3:
            every = node_at(grid.loaded.root, at[:1])
            names = every.entries if isinstance(every, Mapping) else {}
            places = [(str(name), (at[0], name, at[2])) for name in names]
        for name, place in places:
            ends = _range(node_at(grid.loaded.root, place), field.unit)
            if ends is not None:
                marks.append(Mark(axis, name, *ends))
    return tuple(marks)


def read_marks(grid: TileGrid, said: Sequence[str]) -> tuple[Mark, ...]:
    """Read what ``--mark`` says.

    Parameters
    ----------
    grid : TileGrid
        The tiles.
    said : sequence of str
        Each ``NAME=LOW..HIGH UNIT``; it is drawn along the first field with this unit.

    Raises
    ------
    SpecError
        If one is no interval, or no field has its unit.
    """
    marks = []
    for text in said:
        found = _MARK.fullmatch(text)
        if found is None or not (is_number(found[2]) and is_number(found[3])):
            raise SpecError(f"{quoted(text)} marks nothing", remedy=EXAMPLE)
        low, high, unit = parse_exact(found[2]), parse_exact(found[3]), found[4] or ""
        axis = next((k for k, field in enumerate(grid.fields) if _takes(field, unit)), None)
        if axis is None or low > high:
            raise SpecError(
                f"{quoted(text)} is not an interval of a field of this map",
                remedy="write it from the smaller end to the larger one, in the unit of a field: "
                + (", ".join(field.unit for field in grid.fields if field.unit) or "none has one"),
            )
        marks.append(Mark(axis, found[1], float(low), float(high)))
    return tuple(marks)


def _takes(field: TileField, unit: str) -> bool:
    return field.cut is TileCut.INTERVAL and field.unit == unit


def _range(node: Node | None, unit: str) -> tuple[float, float] | None:
    """Return the range of a quantity; None if it has another unit, or none is there."""
    ends: list[Node] = []
    if isinstance(node, Mapping):
        inner = node.entries.get("range")
        ends = list(inner.items) if isinstance(inner, Items) else []
    elif isinstance(node, Scalar):
        ends = [node, node]
    numbers = []
    for end in ends:
        number, _, own = end.text.partition(" ") if isinstance(end, Scalar) else ("", "", "")
        if own.strip() == unit and is_number(number):
            numbers.append(float(parse_exact(number)))
    return (numbers[0], numbers[1]) if len(numbers) == 2 else None
