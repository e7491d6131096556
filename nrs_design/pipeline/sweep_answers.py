"""Answers of the points of a sweep: in a file, a line each, and as a table, a column for each fact.

A sweep goes on from the file, which proves nothing: what claims to be proved or refuted is used
again only as far as a certificate beside it, which is checked again, shows the same.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, TypeAlias

from nrs_design.errors import NrsDesignError
from nrs_design.files import open_regular
from nrs_design.output import SWEEP_ANSWERS, check_place, write_output
from nrs_design.proof.text import quoted
from nrs_design.spec.faults import did_you_mean

Cell: TypeAlias = str | int | float | bool | None
Row: TypeAlias = Mapping[str, Cell]
# Facts that name a file or its content, of which no table is made.
_NAMES = ("sha256", "_id", "schema")
# Longer words are sentences, or exact numbers.
SHORT = 20
_EXACT = "_exact"

# Verdicts, and first parts of names of claimed numbers.
_VERDICTS = frozenset({"proved", "refuted", "exists", "impossible"})
_CLAIMED = ("claim", "proved", "refuted", "certified", "kept_up_to", "decay_rate_exact")
# Facts about the search, which an answer may hold beside its certificate.
_BESIDE = frozenset(
    {"schema", "spec", "spec_sha256", "method", "attempts", "relief"}
    | {"decay_rate_limit", "decay_rate_unit"}
)


@dataclass(frozen=True, slots=True)
class PointAnswer:
    """Answer of one point."""

    values: tuple[str, ...]  # One for each field
    code: int  # As the command ends with
    # What the spec of the point means, the command and the version of this program, hashed.
    key: str = ""
    result: Mapping[str, Any] | None = None  # The JSON document, without times and places of files
    certificate: str = ""  # Text of the certificate, if any
    error: Mapping[str, Any] | None = None  # Error instead of an answer


def read_answers(file: Path) -> dict[tuple[str, ...], PointAnswer]:
    """Return the last answer of each point; lines that were cut off are left out."""
    check_place(file, SWEEP_ANSWERS)
    if not file.exists():
        write_output(file, SWEEP_ANSWERS)
    found = {}
    with open_regular(file) as opened:
        for line in opened:
            try:
                said = json.loads(line)
                values, code, key = tuple(map(str, said["values"])), int(said["code"]), said["key"]
                result, certificate = dict(said["result"]), str(said["certificate"])
            except (ValueError, LookupError, TypeError, OverflowError, RecursionError):
                continue
            found[values] = PointAnswer(values, code, key, result, certificate)
    return found


def add_answer(file: Path, answer: PointAnswer) -> None:
    """Write an answer behind the others, on a line of its own."""
    with file.open("a", encoding="ascii") as opened:
        opened.write(f"\n{json.dumps(asdict(answer))}")


def is_shown(result: Mapping[str, Any], shown: Mapping[str, Any]) -> bool:
    """Tell whether a kept answer says nothing beyond what was shown just now.

    `shown` is what a certificate shows that was checked again, under the names of the answer; empty
    without one, and then nothing may be claimed.
    """
    same = all(name in result and result[name] == value for name, value in shown.items())
    rest = {name: value for name, value in result.items() if name not in shown}
    known = not shown or rest.keys() <= _BESIDE
    return same and known and not _claims(rest)


def _claims(said: object) -> bool:
    """Tell whether a document claims that something is proved, or refuted; zero is a claim, too."""
    if isinstance(said, Mapping):
        return any(
            (str(name).startswith(_CLAIMED) and (bool(value) or type(value) in (int, float)))
            or _claims(value)
            for name, value in said.items()
        )
    if isinstance(said, list | tuple):
        return any(map(_claims, said))
    return isinstance(said, str) and said.lower() in _VERDICTS


def flat(document: object, name: str = "") -> Iterator[tuple[str, Cell]]:
    """Yield each value of a JSON document with its dotted name.

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


def chosen(rows: Sequence[Row], wanted: Sequence[str]) -> list[str]:
    """Return the facts that are asked for, each by its whole name, or by how the shortest end."""
    found: list[str] = []
    for name in wanted:
        every = facts_in(rows)
        named = [one for one in every if one == name or one.endswith(f".{name}")]
        if not named:
            told = [*telling(rows), *every]
            raise NrsDesignError(
                f"no answer has a fact {quoted(name)}", remedy=did_you_mean(name, told, "there are")
            )
        # Facts of the same name further down are parts of others.
        least = min(one.count(".") for one in named)
        found += [one for one in named if one.count(".") == least]
    return list(dict.fromkeys(found))


def cell_text(value: Cell) -> str:
    """Write a fact for people."""
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
