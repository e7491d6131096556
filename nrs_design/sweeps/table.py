"""Answers of all points as one table: a column for each fact that is one number or word."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from nrs_design.errors import NrsDesignError
from nrs_design.proof.text import quoted
from nrs_design.spec.faults import did_you_mean

Cell: TypeAlias = str | int | float | bool | None
Row: TypeAlias = Mapping[str, Cell]

# Facts that name a file or its content, of which no table is made.
_NAMES = ("sha256", "_id", "schema")
# Longer words are sentences, or exact numbers.
SHORT = 20
_EXACT = "_exact"


def flat(document: object, name: str = "") -> Iterator[tuple[str, Cell]]:
    """Yield each number and word of a JSON document with its dotted name.

    Items of a list are called by their ``name``, else counted from 0.
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
    telling = [n for n in first if n in differ - long and not n.endswith(_EXACT)]
    # What is said at the top says most.
    return Columns(tuple(first), tuple(sorted(telling, key=lambda name: name.count("."))))


def chosen(columns: Columns, wanted: Sequence[str]) -> list[str]:
    """Return the facts that are asked for, each by its whole name, or by how the shortest end."""
    found: list[str] = []
    for name in wanted:
        named = [one for one in columns.every if one == name or one.endswith(f".{name}")]
        if not named:
            told = [*columns.telling, *columns.every]
            raise NrsDesignError(
                f"no answer has a fact {quoted(name)}", remedy=did_you_mean(name, told, "there are")
            )
        # Facts of the same name further down are parts of others.
        least = min(one.count(".") for one in named)
        found += [one for one in named if one.count(".") == least]
    return list(dict.fromkeys(found))


def short_names(names: Sequence[str]) -> list[str]:
    """Return the shortest ending of each dotted name that no other one has."""
    return [_ending(name, names) for name in names]


def _ending(name: str, names: Sequence[str]) -> str:
    parts = name.split(".")
    ends = (".".join(parts[at:]) for at in range(len(parts) - 1, -1, -1))
    return next(
        end for end in ends if end == name or sum(f".{n}".endswith(f".{end}") for n in names) == 1
    )


def cell_text(value: Cell) -> str:
    """Write a fact for people."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
