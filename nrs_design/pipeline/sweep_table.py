"""Answers of all points as one table: a column for each fact that is one number or word."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
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
        inner = [(_called(item, index), item) for index, item in enumerate(document)]
    elif document is None or isinstance(document, str | int | float | bool):
        yield name, document
    for key, value in inner:
        if not key.endswith(_NAMES):
            yield from flat(value, f"{name}.{key}" if name else key)


def _called(item: object, index: int) -> str:
    name = item.get("name") if isinstance(item, Mapping) else None
    return name if isinstance(name, str) and name else str(index)


def facts_in(rows: Sequence[Row]) -> list[str]:
    """Return the names of all facts, in the order in which they are met."""
    return list(dict.fromkeys(name for row in rows for name in row))


def telling(rows: Sequence[Row]) -> list[str]:
    """Return the facts that differ from answer to answer and are short, the topmost first."""
    rows = [row for row in rows if row]
    found = [
        name
        for name in facts_in(rows)
        if not name.endswith(_EXACT)
        and len({row.get(name) for row in rows}) > 1
        and all(
            isinstance(row.get(name), float) or len(str(row.get(name))) <= SHORT for row in rows
        )
    ]
    return sorted(found, key=lambda name: name.count("."))


def choose_facts(rows: Sequence[Row], names: Sequence[str]) -> list[str]:
    """Return the facts that are asked for, each by its whole name, or by how the shortest end."""
    found: list[str] = []
    for name in names:
        facts = facts_in(rows)
        named = [one for one in facts if one == name or one.endswith(f".{name}")]
        if not named:
            ordered = [*telling(rows), *facts]
            raise NrsDesignError(
                f"no answer has a fact {quoted(name)}",
                remedy=did_you_mean(name, ordered, "there are"),
            )
        # Facts of the same name further down are parts of others.
        depth = min(one.count(".") for one in named)
        found += [one for one in named if one.count(".") == depth]
    return list(dict.fromkeys(found))


def cell_text(value: Cell) -> str:
    """Write a fact for people."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
