"""Catalogue of assumptions: the sentence of each, its bound, and a test on the robot.

`assumptions.toml` holds the sentences by kind and name. An `Assumption` has the id of a sentence
and the values of its fields.
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
    """Support of an assumption."""

    TESTED = "tested"
    ARGUED = "argued"
    OPEN = "open"


# Kind of the assumption that contact is maintained.
CONTACT_KEPT = "contact-kept"
# Name of the table of texts by field and key; it is no kind.
_WORDS = "words"


@dataclass(frozen=True, slots=True, eq=False)
class AssumptionKind:
    """Kind of assumption: sentences with one subject."""

    id: str
    name: str  # In a few words
    where: str  # Specs with this kind of assumption
    within: str  # Bound of sentences without a bound of their own
    breaks: str  # Consequence if the assumption is false
    test: str  # Test on the robot
    sentences: Mapping[str, str]  # Templates by name
    bounds: Mapping[str, str] = field(default_factory=dict)  # Templates of bounds by name
    about: str = ""  # Field of the spec, such as ``sampling.period``
    omits: str = ""  # Effects that are not modelled, in a few words
    argued: bool = False  # The construction of the controller implies it

    @property
    def standing(self) -> Standing:
        """Support without records of the robot: argued or open."""
        return Standing.ARGUED if self.argued else Standing.OPEN


class _Values(tuple[str, ...]):
    """Values of a field, with the formats that templates use."""

    __slots__ = ()

    def __format__(self, form: str) -> str:
        """Return the values as text.

        ``switches``: pairs of names; ``is``: a number or an interval after its name; ``capital``:
        with a capital letter; otherwise a list with that conjunction.
        """
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
def _table() -> dict[str, dict[str, Any]]:
    return tomllib.loads(_TABLE.read_text(encoding="utf-8"))


@cache
def kinds() -> dict[str, AssumptionKind]:
    """Return the catalogue by id of the kind."""
    return {id: AssumptionKind(id, **row) for id, row in _table().items() if id != _WORDS}


def keyed_texts() -> dict[str, dict[str, str]]:
    """Return the texts that stand for keys, by field and key."""
    return _table()[_WORDS]


def catalogue_kind(assumption: Assumption) -> AssumptionKind:
    """Return the kind of an assumption; a KeyError if the catalogue does not have it."""
    return kinds()[assumption.id.partition(".")[0]]


def sentence(assumption: Assumption) -> str:
    """Return the sentence of an assumption; a LookupError if the catalogue does not have it."""
    template = catalogue_kind(assumption).sentences.get(_name(assumption))
    return _rendered(assumption, template or _law_sentences()[assumption.id])


def bound_of(assumption: Assumption) -> str:
    """Return the bound of an assumption, as text; a LookupError if a field is missing."""
    kind = catalogue_kind(assumption)
    return _rendered(assumption, kind.bounds.get(_name(assumption), kind.within))


def sentence_with_bound(assumption: Assumption) -> str:
    """Return the sentence of an assumption and its bound, even of a stranger's certificate."""
    try:
        return f"{sentence(assumption)} (within: {bound_of(assumption)})"
    except (LookupError, ValueError):
        return f"{assumption}, which this version does not know"


def sentences(assumptions: Iterable[Assumption]) -> tuple[str, ...]:
    """Return the sentences of assumptions."""
    return tuple(map(sentence, assumptions))


def _name(assumption: Assumption) -> str:
    return assumption.id.partition(".")[2]


@cache
def _law_sentences() -> dict[str, str]:
    """Return templates of single laws, from the files of the laws."""
    from nrs_design.controllers.laws import LAWS
    from nrs_design.spec.environment import ENVIRONMENT_LAWS

    laws: tuple[Any, ...] = (*LAWS.values(), *ENVIRONMENT_LAWS)
    return {id: text for law in laws for id, text in law.sentences.items()}


def _rendered(assumption: Assumption, template: str) -> str:
    """Return a template with the fields of an assumption; a field left out has no words."""
    fields = {name: _Values(values) for name, values in assumption.fields}
    for name, texts in keyed_texts().items():
        fields[name] = _Values(texts[key].format(**fields) for key in fields.get(name, ()))
    return template.format(**fields)


def omitted(assumptions: Iterable[Assumption]) -> tuple[str, ...]:
    """Return the effects that are not modelled, in a few words each."""
    found = (_rendered(item, catalogue_kind(item).omits) for item in assumptions)
    return tuple(dict.fromkeys(text for text in found if text))
