"""All points of a sweep: every combination of the values of its fields, in one order."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted
from nrs_design.spec.document import Mapping, Node, Scalar, parse_document, read_source
from nrs_design.spec.document import Sequence as Items
from nrs_design.spec.edits import Edit, Keys, node_at, saying_instead
from nrs_design.spec.exact import is_number
from nrs_design.spec.faults import did_you_mean
from nrs_design.spec.load import read_axes
from nrs_design.spec.task_space import file_of
from nrs_design.spec.units import parse_unit
from nrs_design.sweeps.values import EXAMPLE, EvenlySpaced, Values, parse_values

MAX_FIELDS = 3
# Beyond that nobody reads the result, and no store holds it.
MAX_POINTS = 1_000_000


@dataclass(frozen=True, slots=True)
class Field:
    """A field of the spec, and the values that it takes."""

    path: str  # As it was written, such as ``environments.soft.stiffness``
    at: Keys  # Its place in the document
    values: Values  # As texts of a spec

    @property
    def unit(self) -> str:
        """The unit of all values; empty if they have none, or several."""
        units = {self.values.unit} if isinstance(self.values, EvenlySpaced) else _units(self.values)
        return units.pop() if len(units) == 1 else ""


@dataclass(frozen=True, slots=True)
class Grid:
    """Fields whose values are combined; the last one changes fastest."""

    fields: tuple[Field, ...]

    @property
    def count(self) -> int:
        """How many points there are."""
        return math.prod(len(field.values) for field in self.fields)

    def texts(self, index: int) -> tuple[str, ...]:
        """Return the values of a point, one for each field."""
        texts: list[str] = []
        for field in reversed(self.fields):
            index, at = divmod(index, len(field.values))
            texts.append(field.values[at])
        return tuple(reversed(texts))

    def changes(self, index: int) -> tuple[Edit, ...]:
        """Return what the spec of a point says in the place of what its file says."""
        texts = self.texts(index)
        return tuple((field.at, text) for field, text in zip(self.fields, texts, strict=True))


def read_grid(spec: Path, said: Sequence[str]) -> Grid:
    """Read what ``--set`` says, and refuse what makes no sweep of this spec."""
    if not 1 <= len(said) <= MAX_FIELDS:
        raise SpecError(
            f"a sweep has one to {MAX_FIELDS} fields, not {len(said)}",
            remedy="set each with --set PATH=VALUES",
        )
    read_axes(spec)
    file = file_of(spec)
    root = parse_document(read_source(file), file)
    grid = Grid(tuple(_field(text, root, file) for text in said))
    _refuse_overlaps(grid)
    if grid.count > MAX_POINTS:
        sizes = " x ".join(str(len(field.values)) for field in grid.fields)
        raise SpecError(
            f"{sizes} = {grid.count} points are more than {MAX_POINTS}",
            remedy="take fewer values of each field, such as 1..250/16, or sweep parts of them",
        )
    for field in grid.fields:
        _check_unit(field, root, spec)
    return grid


def _field(said: str, root: Node, file: Path) -> Field:
    path, equals, values = said.partition("=")
    path = path.strip()
    if not equals:
        raise SpecError(f"{quoted(said)} sets nothing", remedy=f"write PATH=VALUES; {EXAMPLE}")
    known = dict(_paths(root, (), ""))
    if path not in known:
        raise SpecError(
            f"there is no field {quoted(path)} in this spec",
            path=file,
            remedy=_nearest(path, known),
        )
    return Field(path, known[path], parse_values(values))


def _paths(node: Node, at: Keys, said: str) -> Iterator[tuple[str, Keys]]:
    """Yield every place of a document: a dotted path, in which items are counted from 0."""
    if at:
        yield said, at
    inner: Sequence[tuple[str | int, Node]] = ()
    if isinstance(node, Mapping):
        inner = tuple(node.entries.items())
    elif isinstance(node, Items):
        inner = tuple(enumerate(node.items))
    for key, below in inner:
        yield from _paths(below, (*at, key), f"{said}.{key}" if said else str(key))


def _nearest(path: str, known: dict[str, Keys]) -> str:
    """Suggest paths that are alike; else what is below the longest part that is there."""
    beside = [name for name in known if not path.startswith(f"{name}.")]
    near = difflib.get_close_matches(path, beside, n=3)
    ends = [name for name in known if name.endswith(f".{path}")][:3]
    if near or ends:
        return f"did you mean {' or '.join(dict.fromkeys((*ends, *near)))}?"
    above, _, last = path.rpartition(".")
    while above and above not in known:
        above, _, last = above.rpartition(".")
    depth = len(known[above]) if above else 0
    start = f"{above}." if above else ""
    inside = [n for n in known if n.startswith(start) and len(known[n]) == depth + 1]
    below = did_you_mean(last, [name.removeprefix(start) for name in inside])
    return f"{below} below {above}" if above else below


def _refuse_overlaps(grid: Grid) -> None:
    """Refuse a field that is set twice, or lies within another that is set."""
    for index, field in enumerate(grid.fields):
        for other in grid.fields[:index]:
            shorter = min(len(field.at), len(other.at))
            if field.at[:shorter] != other.at[:shorter]:
                continue
            same = field.at == other.at
            what = "is set twice" if same else f"and {other.path} are about one another"
            raise SpecError(f"{field.path} {what}", remedy="set one of them")


def _check_unit(field: Field, root: Node, spec: Path) -> None:
    """Refuse values in another unit than what is there, if the spec does not take them, either."""
    value = field.values[0]
    there = [_dimension(node.text) for node in _scalars(node_at(root, field.at))]
    if _dimension(value) in there:
        return
    with saying_instead(file_of(spec), ((field.at, value),)):
        try:
            read_axes(spec)
        except SpecError as error:
            # What else is wrong with this value is said of its point.
            if _is_of(error, field, root):
                raise


def _is_of(error: SpecError, field: Field, root: Node) -> bool:
    node = node_at(root, field.at)
    assert node is not None
    place = node.position
    return any((f.line, f.column) == (place.line, place.column) for f in error.faults)


def _units(texts: Sequence[str]) -> set[str]:
    return {
        unit if is_number(number) else "" for number, _, unit in (t.partition(" ") for t in texts)
    }


def _scalars(node: Node | None) -> Iterator[Scalar]:
    if isinstance(node, Scalar):
        yield node
    elif isinstance(node, Mapping):
        for inner in node.entries.values():
            yield from _scalars(inner)
    elif isinstance(node, Items):
        for inner in node.items:
            yield from _scalars(inner)


def _dimension(text: str) -> tuple[int, ...] | None:
    """Return the dimension of a quantity; None of what has no unit, or one that is not known."""
    unit = text.partition(" ")[2].strip()
    try:
        return parse_unit(unit).dimension if unit else None
    except SpecError:
        return None
