"""All points of a sweep: every combination of the values of its fields, in one order.

Values are ``1,2,5 N*m/rad`` or ``1..250/16 N*m/rad``, exactly.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from pathlib import Path

from nrs_design.errors import SpecError
from nrs_design.proof.text import exact_text, quoted
from nrs_design.spec import parse_exact
from nrs_design.spec.document import Mapping, Node, parse_document, read_source
from nrs_design.spec.document import Sequence as Items
from nrs_design.spec.edits import Edit, Keys
from nrs_design.spec.exact import is_number
from nrs_design.spec.faults import did_you_mean
from nrs_design.spec.load import read_axes
from nrs_design.spec.task_space import file_of

MAX_FIELDS = 3
# A larger result has no reader.
MAX_POINTS = 20_000
EXAMPLE = "write a list such as '1,2,5 N*m/rad', or a range such as '1..250/16 N*m/rad'"
_END = r"[+-]?(?:[0-9]+(?:\.[0-9]+)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_RANGE = re.compile(rf"({_END})\.\.({_END})/([0-9]{{1,9}})(?: +(\S.*))?")


@dataclass(frozen=True, slots=True)
class Field:
    """A field of the spec, and the values that it takes."""

    path: str  # Text of the path, such as ``environments.soft.stiffness``
    at: Keys  # Its place in the document
    values: Sequence[str]  # As a spec writes them

    @property
    def unit(self) -> str:
        """Common unit of all values, or empty."""
        parts = [text.partition(" ") for text in self.values]
        units = {unit if is_number(number) else "" for number, _, unit in parts}
        return units.pop() if len(units) == 1 else ""


@dataclass(frozen=True, slots=True)
class Grid:
    """Fields whose values are combined; the last one changes fastest."""

    fields: tuple[Field, ...]

    @property
    def points(self) -> list[tuple[str, ...]]:
        """The values of each point, one for each field."""
        return list(product(*(field.values for field in self.fields)))

    def changes(self, point: tuple[str, ...]) -> tuple[Edit, ...]:
        """Return the edits of the spec for a point."""
        return tuple((field.at, text) for field, text in zip(self.fields, point, strict=True))


def read_grid(spec: Path, texts: Sequence[str]) -> Grid:
    """Read the texts of ``--set``, and refuse them if they do not fit the spec."""
    if not 1 <= len(texts) <= MAX_FIELDS:
        raise SpecError(
            f"a sweep has one to {MAX_FIELDS} fields, not {len(texts)}",
            remedy="set each with --set PATH=VALUES",
        )
    read_axes(spec)
    file = file_of(spec)
    known = dict(_paths(parse_document(read_source(file), file), (), ""))
    fields = tuple(_field(text, known, file) for text in texts)
    for index, field in enumerate(fields):
        for other in fields[:index]:
            shorter = min(len(field.at), len(other.at))
            if field.at[:shorter] == other.at[:shorter]:
                raise SpecError(
                    f"{field.path} and {other.path} are about one another",
                    remedy="set one of them, and once",
                )
    sizes = [len(field.values) for field in fields]
    if math.prod(sizes) > MAX_POINTS:
        raise SpecError(
            f"{' x '.join(map(str, sizes))} points are more than {MAX_POINTS}",
            remedy="take fewer values of each field, or sweep parts of them",
        )
    return Grid(fields)


def _field(said: str, paths: dict[str, Keys], file: Path) -> Field:
    path, equals, values = said.partition("=")
    path = path.strip()
    if not equals:
        raise SpecError(f"{quoted(said)} sets nothing", remedy=f"write PATH=VALUES; {EXAMPLE}")
    if path not in paths:
        # Most typing errors are in the last word.
        prefix = f"{path.rpartition('.')[0]}."
        siblings = [name for name in paths if name.startswith(prefix)] or [*paths]
        called = [name for name in paths if name.endswith(f".{path}")]
        raise SpecError(
            f"there is no field {quoted(path)} in this spec",
            path=file,
            remedy=did_you_mean(path, siblings, called=called),
        )
    return Field(path, paths[path], parse_values(values))


def _paths(node: Node, keys: Keys, said: str) -> Iterator[tuple[str, Keys]]:
    """Yield every place of a document: a dotted path, in which items are counted from 0."""
    if keys:
        yield said, keys
    inner: Sequence[tuple[str | int, Node]] = ()
    if isinstance(node, Mapping):
        inner = tuple(node.entries.items())
    elif isinstance(node, Items):
        inner = tuple(enumerate(node.items))
    for key, child in inner:
        yield from _paths(child, (*keys, key), f"{said}.{key}" if said else str(key))


def parse_values(text: str) -> tuple[str, ...]:
    """Read the values of one field: a list with commas, or a range ``LOW..HIGH/COUNT UNIT``.

    The last unit is that of all that have none.
    """
    text = text.strip()
    if found := _RANGE.fullmatch(text):
        low, high = parse_exact(found[1]), parse_exact(found[2])
        count = int(found[3])
        if low >= high or not 2 <= count <= MAX_POINTS:
            raise SpecError(
                f"{quoted(text)} is no range of 2 to {MAX_POINTS} values, the lowest first",
                remedy=EXAMPLE,
            )
        steps = (Fraction(index, count - 1) for index in range(count))
        return tuple(_add_unit(exact_text(low + (high - low) * s), found[4]) for s in steps)
    items = [item.strip() for item in text.split(",")]
    if not all(items) or ".." in text or any(mark in text for mark in "[]{}"):
        raise SpecError(f"{quoted(text)} has no values of one field", remedy=EXAMPLE)
    unit = items[-1].partition(" ")[2].strip()
    values = tuple(_add_unit(item, unit) if is_number(item) else item for item in items)
    if len({*values}) < len(values):
        raise SpecError(f"{quoted(text)} has a value twice", remedy="leave one out")
    return values


def _add_unit(number: str, unit: str | None) -> str:
    return f"{number} {unit}" if unit else number
