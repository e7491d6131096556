"""Tiles: what a spec says in each of them, and in boxes of many.

A field that takes a range is cut into intervals: a tile is about all values of its interval. Of
``sampling.delay: [0, 1]``, the upper end takes each value: a tile is about all ages up to it. Any
other field takes each value by itself. Gains stay what they are: they are given in the spec of
every box.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from enum import StrEnum
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

from nrs_design.errors import SpecError
from nrs_design.proof.text import exact_text
from nrs_design.spec import LoadedSpec, parse_exact
from nrs_design.spec.document import (
    Data,
    Mapping,
    Node,
    Scalar,
    Sequence,
    parse_document,
    to_data,
)
from nrs_design.spec.edits import changed, node_at
from nrs_design.spec.load import respecified
from nrs_design.spec.spec_document import SpecDocument, plain
from nrs_design.spec.task_space import file_of
from nrs_design.sweeps.grid import Field, read_grid
from nrs_design.sweeps.values import Spaced

# More tiles than that are no map that anybody reads.
MOST_TILES = 65_536
# Parts of a spec by which gains are designed.
OF_THE_DESIGN = frozenset({"controllers", "motion_loop", "limits", "design", "goals"})
# The list of two that is a range of which only the upper end changes.
DELAY = ("sampling", "delay")

Span = tuple[int, int]  # First and last place along a field
Box = tuple[Span, ...]  # One for each field


class TileCut(StrEnum):
    """How a field is cut into tiles."""

    INTERVAL = "interval"  # Between neighbouring values
    UP_TO = "up to"  # From the declared lower end up to each value
    POINT = "point"  # Each value by itself


@dataclass(frozen=True, slots=True)
class TileField:
    """A field that is cut into tiles."""

    field: Field
    cut: TileCut
    unit: str
    values: tuple[float, ...]  # Of intervals the borders, one more than there are tiles

    @property
    def count(self) -> int:
        """How many tiles there are along the field."""
        return len(self.values) - (self.cut is TileCut.INTERVAL)

    def said(self, span: Span, there: Node | None) -> Data:
        """Return what the spec says in tiles of a span.

        Parameters
        ----------
        span : (int, int)
            First and last tile; of a `POINT`, the same.
        there : Node or None
            What the spec says where it stands.
        """
        first, last = span
        values = self.field.values
        if self.cut is TileCut.POINT:
            return values[first]
        if self.cut is TileCut.UP_TO:
            assert isinstance(there, Sequence)
            return (to_data(there.items[0]), values[last])
        low, high = values[first], values[last + 1]
        ends = parse_exact(low.partition(" ")[0]), parse_exact(high.partition(" ")[0])
        middle = exact_text((ends[0] + ends[1]) / 2)
        nominal = f"{middle} {self.unit}" if self.unit else middle
        said: dict[str, Data] = {"nominal": nominal, "range": (low, high)}
        if isinstance(there, Mapping) and "varies" in there.entries:
            said["varies"] = to_data(there.entries["varies"])
        return said

    def text(self, place: int) -> str:
        """Write what a tile covers."""
        values = [
            text.partition(" ")[0] for text in map(self.field.values.__getitem__, self._at(place))
        ]
        unit = f" {self.unit}" if self.unit else ""
        return f"{'..'.join(values)}{unit}"

    def cut_finer(self, tiles: Collection[int]) -> TileField:
        """Return the field with some of its tiles halved; only intervals can be."""
        if self.cut is not TileCut.INTERVAL or not tiles:
            return self
        texts = list[str]()
        for place in range(self.count):
            low, high = self._ends(place)
            unit = f" {self.unit}" if self.unit else ""
            texts.append(self.field.values[place])
            if place in tiles:
                texts.append(f"{exact_text((low + high) / 2)}{unit}")
        finer = Field(self.field.path, self.field.at, (*texts, self.field.values[self.count]))
        return TileField(finer, self.cut, self.unit, _numbers(finer))

    def span_of(self, coarse: TileField, place: int) -> Span:
        """Return which tiles lie in a tile of the field as it was before `cut_finer`."""
        if self.cut is not TileCut.INTERVAL:
            return place, place
        every = list(_texts(self.field))
        ends = [every.index(coarse.field.values[k]) for k in (place, place + 1)]
        return ends[0], ends[1] - 1

    def _ends(self, place: int) -> tuple[Fraction, Fraction]:
        low, high = (
            parse_exact(self.field.values[k].partition(" ")[0]) for k in (place, place + 1)
        )
        return low, high

    def _at(self, place: int) -> tuple[int, ...]:
        return (place, place + 1) if self.cut is TileCut.INTERVAL else (place,)


@dataclass(frozen=True, slots=True)
class TileGrid:
    """All tiles of one to three fields of a spec."""

    loaded: LoadedSpec
    fields: tuple[TileField, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """How many tiles there are along each field."""
        return tuple(field.count for field in self.fields)

    @property
    def count(self) -> int:
        """How many tiles there are."""
        return math.prod(self.shape)

    def spec_of(self, box: Box) -> LoadedSpec:
        """Return what the spec says of all tiles of a box at once.

        Raises
        ------
        SpecError
            If that is no valid spec.
        """
        root = self.loaded.root
        for field, span in zip(self.fields, box, strict=True):
            there = node_at(root, field.field.at)
            root = changed(root, field.field.at, field.said(span, there))
        return respecified(self.loaded, root)

    def text_of(self, box: Box) -> str:
        """Return the text of that spec, with the comments of the file.

        Raises
        ------
        SpecError
            If a comment would be lost, or the text would not say the same.
        """
        document = SpecDocument(self.loaded)
        for field, span in zip(self.fields, box, strict=True):
            *above, last = field.field.at
            node = document.root
            for key in above:
                node = node[key]
            said = plain(field.said(span, node_at(self.loaded.root, field.field.at)))
            if isinstance(last, int):
                node[last] = said
            else:
                document.put(node, last, said)
        text = document.text()
        root = parse_document(text, self.loaded.path)
        if respecified(self.loaded, root).sha256 != self.spec_of(box).sha256:
            raise SpecError("the file cannot be rewritten with these values", path=self.loaded.path)
        return text


def read_tiles(loaded: LoadedSpec, path: Path, said: list[str]) -> TileGrid:
    """Read what ``--over`` says, and refuse what makes no map of this spec.

    Parameters
    ----------
    loaded : LoadedSpec
        The spec, with all gains given.
    path : Path
        Its address.
    said : list of str
        Each ``PATH=LOW..HIGH/COUNT UNIT``, or a list of values.

    Raises
    ------
    SpecError
        If a path is not there, values are none or do not fit, gains would change, or the tiles are
        too many.
    """
    if file_of(path) != path:
        raise SpecError(
            "a map is of a spec with one axis", path=path, remedy="copy the axis into its own file"
        )
    grid = read_grid(path, said)
    fields = tuple(_cut(loaded, field) for field in grid.fields)
    count = math.prod(field.count for field in fields)
    if count > MOST_TILES:
        sizes = " x ".join(str(field.count) for field in fields)
        raise SpecError(
            f"{sizes} = {count} tiles are more than {MOST_TILES}",
            remedy="cut the fields into fewer, such as 1..250/16",
        )
    return TileGrid(loaded, fields)


def _cut(loaded: LoadedSpec, field: Field) -> TileField:
    there = node_at(loaded.root, field.at)
    if field.at[0] in OF_THE_DESIGN:
        raise SpecError(
            f"{field.path} is about gains, which stay the same in all tiles",
            path=loaded.path,
            remedy="use sweep, which designs them anew at every point",
        )
    values = _numbers(field)
    if field.at == DELAY and isinstance(there, Sequence):
        _check_ascending(field, values)
        return TileField(field, TileCut.UP_TO, field.unit, values)
    if isinstance(there, Sequence) or "range" in field.at:
        raise SpecError(
            f"{field.path} is a list",
            path=loaded.path,
            remedy="name the quantity, such as environments.soft.stiffness, or an item of a list",
        )
    if values and _takes_ranges(loaded, field, there):
        _check_ascending(field, values)
        finer = _with_borders(field)
        return TileField(finer, TileCut.INTERVAL, field.unit, _numbers(finer))
    numbers = values or tuple(map(float, range(len(field.values))))
    return TileField(field, TileCut.POINT, field.unit if values else "", numbers)


def _texts(field: Field) -> Iterator[str]:
    return (field.values[at] for at in range(len(field.values)))


def _numbers(field: Field) -> tuple[float, ...]:
    """Return the numbers of all values; none, if one is no number."""
    try:
        return tuple(float(parse_exact(text.partition(" ")[0])) for text in _texts(field))
    except (SpecError, ValueError):
        return ()


def _check_ascending(field: Field, values: tuple[float, ...]) -> None:
    """Refuse values that are not in order, or in several units: tiles lie between them."""
    units = {text.partition(" ")[2] for text in _texts(field)}
    ordered = all(a < b for a, b in pairwise(values))
    if not (values and ordered and len(units) == 1):
        raise SpecError(
            f"the values of {field.path} do not ascend",
            remedy="write them from the smallest to the largest, in one unit",
        )


def _with_borders(field: Field) -> Field:
    """Return as many intervals as a range has values, with one border more; whole numbers stay."""
    if not isinstance(field.values, Spaced):
        return field
    spaced = field.values
    whole = spaced.low.denominator == spaced.high.denominator == 1
    if whole and spaced.count == spaced.high - spaced.low + 1:
        return field
    finer = Spaced(spaced.low, spaced.high, spaced.count + 1, spaced.unit)
    return Field(field.path, field.at, finer)


def _takes_ranges(loaded: LoadedSpec, field: Field, there: Node | None) -> bool:
    """Tell whether what stands there could be a range."""
    if isinstance(there, Mapping):
        return "nominal" in there.entries
    if not isinstance(there, Scalar):
        return False
    said: Data = {"nominal": there.text, "range": (there.text, there.text)}
    try:
        respecified(loaded, changed(loaded.root, field.at, said))
    except SpecError:
        return False
    return True
