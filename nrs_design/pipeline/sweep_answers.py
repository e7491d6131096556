"""Answers of points in a file, from which a sweep goes on: a line each, written as they come.

The file proves nothing: what claims to be proved or refuted is used again only as far as a
certificate beside it, which is checked again, shows the same.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from nrs_design.files import open_regular
from nrs_design.output import SWEEP_ANSWERS, check_place, write_output

# Words that are verdicts, and how the names of numbers begin that are claimed.
_VERDICTS = frozenset({"proved", "refuted", "exists", "impossible"})
_CLAIMED = ("claim", "proved", "refuted", "certified", "kept_up_to", "decay_rate_exact")
# What an answer with a certificate may hold beside what that shows: how it was found.
_BESIDE = frozenset(
    {"schema", "spec", "spec_sha256", "method", "attempts", "relief"}
    | {"decay_rate_limit", "decay_rate_unit"}
)


@dataclass(frozen=True, slots=True)
class PointAnswer:
    """What came of one point."""

    values: tuple[str, ...]  # Of the fields, in their order
    code: int  # As the command ends with
    # What the spec of the point means, the command and the version of this program, hashed.
    key: str = ""
    result: Mapping[str, Any] | None = None  # The JSON document, without times and places of files
    certificate: str = ""  # Text of its file, if there is one
    error: Mapping[str, Any] | None = None  # What is wrong, if that kept it from an answer


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
