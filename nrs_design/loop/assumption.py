"""What is taken for granted: a sentence of a certificate, with what a reader needs to test it.

`assumptions.toml` has every sentence, by its kind and its name.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any, Self

_TABLE = Path(__file__).with_name("assumptions.toml")


class Standing(StrEnum):
    """How well an assumption is supported."""

    TESTED = "tested"
    ARGUED = "argued"
    OPEN = "open"


# The kind that says that contact is kept.
KEPT = "contact-kept"


@dataclass(frozen=True, slots=True)
class AssumptionKind:
    """What is common to the sentences that take one thing for granted."""

    id: str
    name: str  # In a few words
    where: str  # Which specs take it for granted
    within: str  # Its bound, where the sentence has no numbers of its own
    breaks: str  # What no longer follows if it is false
    test: str  # How to test it on the robot
    field: str = ""  # Of the spec that is about it, such as ``sampling.period``
    omits: str = ""  # What is not modelled, in a few words
    argued: bool = False  # It follows from how the controller is made
    says: tuple[tuple[str, str], ...] = ()  # Its sentences by name

    @property
    def standing(self) -> Standing:
        """Argued or open; that it was tested, a spec says."""
        return Standing.ARGUED if self.argued else Standing.OPEN


class Assumption(str):
    """The sentence that a certificate holds, which knows its id and its bound.

    A certificate keeps the sentence alone: what is read from one is a plain string.
    """

    __slots__ = ("bound", "id")
    id: str
    bound: str

    def __new__(cls, sentence: str, id: str, bound: str) -> Self:
        """Attach id and bound to a sentence."""
        made = super().__new__(cls, sentence)
        made.id, made.bound = id, bound
        return made

    def __reduce__(self) -> tuple[type[Self], tuple[str, str, str]]:
        """Return what a copy is made from."""
        return type(self), (str(self), self.id, self.bound)

    @property
    def kind(self) -> AssumptionKind:
        """What breaks if it is false, and how to test it."""
        return kinds()[self.id.partition(".")[0]]


def omitted(granted: Iterable[str]) -> tuple[str, ...]:
    """Return what is not modelled, in a few words each; the sentences say it whole.

    Those that are no `Assumption` say nothing of their kind.
    """
    said = (_omits(item) for item in granted if isinstance(item, Assumption))
    return tuple(dict.fromkeys(words for words in said if words))


def _omits(assumption: Assumption) -> str:
    words, beside = assumption.kind.omits, ", saturation"
    if not words or "-disturbed" not in assumption.id:
        return words
    # What `disturbances` bound is modelled, and saturation is not among it.
    return f"{words.removesuffix(beside)} beyond what disturbances bound{beside}"


@cache
def kinds() -> dict[str, AssumptionKind]:
    """Return the table by ids."""
    table: dict[str, dict[str, Any]] = tomllib.loads(_TABLE.read_text(encoding="utf-8"))
    return {
        id: AssumptionKind(id, **{**row, "says": tuple(row["says"].items())})
        for id, row in table.items()
    }


def say(id: str, bound: str | None = None, /, **fields: object) -> Assumption:
    """Return an assumption in words, by the id of its sentence, such as ``tissue.linear``.

    `bound` are its numbers, by default what the kind says; the fields are those of the sentence.
    """
    kind_id, _, name = id.partition(".")
    kind = kinds()[kind_id]
    sentence = dict(kind.says)[name].format(**fields)
    return Assumption(sentence, id, kind.within if bound is None else bound)
