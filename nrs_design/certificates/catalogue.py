"""The catalogue of assumptions: each in words, its bound, and how to test it on the robot.

`assumptions.toml` has every sentence, by its kind and its name. An `Assumption` names one, and says
what it is about.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from functools import cache
from pathlib import Path
from typing import Any

from nrs_design.proof.assumption import Assumption

_TABLE = Path(__file__).with_name("assumptions.toml")
_JOINED = {"": " and ", "or": " or ", ",": ", ", ";": "; "}


class Standing(StrEnum):
    """How well an assumption is supported."""

    TESTED = "tested"
    ARGUED = "argued"
    OPEN = "open"


# The kind that says that contact is kept.
KEPT = "contact-kept"


@dataclass(frozen=True, slots=True, eq=False)
class AssumptionKind:
    """What is common to the sentences that take one thing for granted."""

    id: str
    name: str  # In a few words
    where: str  # Which specs take it for granted
    within: str  # Its bound, where the sentence has none of its own
    breaks: str  # What no longer follows if it is false
    test: str  # How to test it on the robot
    says: Mapping[str, str]  # Its sentences by name
    bounds: Mapping[str, str] = field(default_factory=dict)  # Of sentences, by name
    words: Mapping[str, Mapping[str, str]] = field(default_factory=dict)  # Of keys, by field
    about: str = ""  # The field of the spec that is about it, such as ``sampling.period``
    omits: str = ""  # What is not modelled, in a few words
    argued: bool = False  # It follows from how the controller is made

    @property
    def standing(self) -> Standing:
        """Argued or open; that it was tested, a spec says."""
        return Standing.ARGUED if self.argued else Standing.OPEN


class _Listed(tuple[str, ...]):
    """What a field says, in the form that the sentence asks for."""

    __slots__ = ()

    def __format__(self, form: str) -> str:
        """Join a list; or say where a number ``is``, or from where to where switches lead."""
        if form == "switches":
            pairs = zip(self[::2], self[1::2], strict=True)
            return ", ".join(f"from {source} to {target}" for source, target in pairs)
        if form == "is":
            (number,) = self
            return f"stays in {number}" if number.startswith("[") else f"is {number}"
        if form == "capital":
            return format(self, "").capitalize()
        return _JOINED[form].join(self)


@cache
def kinds() -> dict[str, AssumptionKind]:
    """Return the catalogue by ids."""
    table = tomllib.loads(_TABLE.read_text(encoding="utf-8"))
    return {id: AssumptionKind(id, **row) for id, row in table.items()}


def catalogue_kind(assumption: Assumption) -> AssumptionKind:
    """Return what breaks if an assumption is false, and how to test it; a KeyError if unknown."""
    return kinds()[assumption.id.partition(".")[0]]


def sentence(assumption: Assumption) -> str:
    """Return an assumption in words; as it stands, if a certificate names one that is unknown."""
    try:
        said = catalogue_kind(assumption).says.get(_name(assumption)) or _of_laws()[assumption.id]
        return _in_words(assumption, said)
    except (LookupError, ValueError):
        fields = "; ".join(f"{name}: {', '.join(value)}" for name, value in assumption.said)
        return f"{assumption.id} ({fields}), which this version does not know"


def bound_of(assumption: Assumption) -> str:
    """Return within what an assumption must hold, in words; a KeyError if its kind is unknown."""
    kind = catalogue_kind(assumption)
    own = kind.bounds.get(_name(assumption))
    return kind.within if own is None else _in_words(assumption, own)


def sentences(granted: Iterable[Assumption]) -> tuple[str, ...]:
    """Return assumptions in words."""
    return tuple(map(sentence, granted))


def _name(assumption: Assumption) -> str:
    return assumption.id.partition(".")[2]


@cache
def _of_laws() -> dict[str, str]:
    """Return what is said of one law alone: it stands in the file of that law."""
    from nrs_design.controllers.laws import LAWS as CONTROL
    from nrs_design.models.contact import LAWS as CONTACT
    from nrs_design.models.contact import LINEAR_LAWS

    laws: tuple[Any, ...] = (*CONTROL.values(), *CONTACT.values(), *LINEAR_LAWS.values())
    return {id: text for law in laws for id, text in law.sentences.items()}


def _in_words(assumption: Assumption, text: str) -> str:
    fields = {name: _Listed(value) for name, value in assumption.said}
    for name, words in catalogue_kind(assumption).words.items():
        keyed = (words[key].format(**fields) for key in fields.get(name, ()))
        fields[name] = _Listed(keyed)
    return text.format(**fields)


def omitted(granted: Iterable[Assumption]) -> tuple[str, ...]:
    """Return what is not modelled, in a few words each; the sentences say it whole."""
    return tuple(dict.fromkeys(words for words in map(_omits, granted) if words))


def _omits(assumption: Assumption) -> str:
    words, beside = catalogue_kind(assumption).omits, ", saturation"
    if not words or "-disturbed" not in assumption.id:
        return words
    # What `disturbances` bound is modelled, and saturation is not among it.
    return f"{words.removesuffix(beside)} beyond what disturbances bound{beside}"
