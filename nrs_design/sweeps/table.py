"""Answers of all points as one table: a column for each fact that is one number or word."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

Cell: TypeAlias = str | int | float | bool | None
Row: TypeAlias = Mapping[str, Cell]

# Facts that name a file or its content, of which no table is made.
_NAMES = ("sha256", "_id", "schema")
# Longer words are sentences, or exact numbers.
SHORT = 20
_EXACT = "_exact"


def flat(document: object, name: str = "") -> Iterator[tuple[str, Cell]]:
    """Yield each number and word of a document with its dotted name.

    Parameters
    ----------
    document : object
        As JSON holds it. Items of a list are called by their ``name``, else counted from 0.
    name : str
        Of the document itself.
    """
    inner: Sequence[tuple[str, object]] = ()
    if isinstance(document, Mapping):
        inner = [(str(key), value) for key, value in document.items() if key != "name"]
    elif isinstance(document, list | tuple):
        inner = [(_called(item, at), item) for at, item in enumerate(document)]
    elif document is None or isinstance(document, str | int | float | bool):
        yield name, document
    for key, value in inner:
        if not key.endswith(_NAMES):
            yield from flat(value, f"{name}.{key}" if name else key)


def _called(item: object, at: int) -> str:
    named = item.get("name") if isinstance(item, Mapping) else None
    return named if isinstance(named, str) and named else str(at)


@dataclass(frozen=True, slots=True)
class Columns:
    """The facts of all points."""

    every: tuple[str, ...]  # In the order in which they are met
    telling: tuple[str, ...]  # Those that differ from point to point, and are short


def fact_columns(rows: Iterable[Row]) -> Columns:
    """Return the facts of all rows; each row is looked at once, and not kept."""
    first: dict[str, Cell] = {}
    differ, long = set[str](), set[str]()
    for count, row in enumerate(rows):
        for name, value in row.items():
            if count and name not in first:
                differ.add(name)
            if first.setdefault(name, value) != value:
                differ.add(name)
            if isinstance(value, str) and len(value) > SHORT:
                long.add(name)
        differ |= first.keys() - row.keys()
    return Columns(
        tuple(first), tuple(n for n in first if n in differ - long and not n.endswith(_EXACT))
    )


def cell_text(value: Cell) -> str:
    """Write a fact for people."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
