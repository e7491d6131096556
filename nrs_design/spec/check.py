"""Checks of a spec as rows of tables: place, condition, message and remedy."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from pydantic_core import PydanticCustomError

from nrs_design.proof.text import quoted
from nrs_design.spec.faults import Location, as_error, did_you_mean, fault

S = TypeVar("S")
T = TypeVar("T")


# Between keys, and not within a place to be filled.
_DOT = re.compile(r"\.(?![^{]*\})")


def _itself(said: Any) -> Iterable[tuple[Location, Any]]:
    return (((), said),)


@dataclass(frozen=True)
class Feature(Generic[S]):
    """Something that a spec may have, which does not combine with everything.

    What a spec is found to have fills the places ``{0}`` of the texts.
    """

    # Words for a sentence, such as "a hand with a mass".
    phrase: str
    # Its place in a spec.
    at: str
    # Remedy: how a spec does without it.
    without: str
    # False, None or "" if a spec lacks it; a text, or several, names the parts that have it.
    find: Callable[[S], object]


@dataclass(frozen=True)
class Row(Generic[S]):
    """A row: at a place, a condition that must not hold, the message, and the remedy.

    What the condition finds fills the places ``{0}``, ``{1}`` of the texts; ``{s}`` is the part of
    the spec that it is about.
    """

    # Keys with dots between, below the part; a key may be a place to be filled, such as ``{0}``.
    at: str
    # False, None, "" or () if nothing is wrong; the first item of an iterator is the finding.
    find: Callable[[S], object]
    message: str
    remedy: str
    # The checked parts, each with its place; by default the whole spec.
    parts: Callable[[Any], Iterable[tuple[Location, Any]]] = _itself
    # Features that do not combine, if the condition is that a spec has all of them.
    features: tuple[Feature[Any], ...] = ()

    def faults(self, said: Any) -> Iterator[PydanticCustomError]:
        """Yield a fault for each part in which the condition holds."""
        for place, part in self.parts(said):
            found = self.find(part)
            if found := next(found, None) if isinstance(found, Iterator) else found:
                # A named tuple is one finding.
                values = found if type(found) is tuple else (found,)
                at = (
                    int(key) if key.isdigit() else key.format(*values, s=part)
                    for key in _DOT.split(self.at)
                    if key
                )
                texts = (text.format(*values, s=part) for text in (self.message, self.remedy))
                yield fault(*texts, *place, *at)


def _filled(text: str, number: int) -> str:
    """Return a text of a feature for the place that it has among several."""
    return text.replace("{0", f"{{{number}")


def each(parts: Callable[[S], Iterable[tuple[Location, T]]], *checks: Row[T]) -> tuple[Row[S], ...]:
    """Return checks of every part of a spec as checks of the whole."""
    return tuple(replace(check, parts=parts) for check in checks)  # type: ignore[misc]


def refuse(
    found: Callable[[S], Iterable[tuple[Location, object]]], message: str, remedy: str
) -> Row[S]:
    """Return the check that there are no findings; each finding, with its place, fills texts."""
    return Row("", lambda item: item, message, remedy, parts=found)


def not_together(
    *features: Feature[S], form: str = "{}: not modelled", because: str = ""
) -> Row[S]:
    """Return the row that refuses features which are not modelled together.

    A spec that has all of them is refused at the place of the first; `form` has a place for what it
    has, and `because` is a clause that says why.
    """

    def find(said: S) -> tuple[object, ...]:
        found = tuple(feature.find(said) for feature in features)
        return found if all(found) else ()

    phrases = [_filled(feature.phrase, i) for i, feature in enumerate(features)]
    ways = dict.fromkeys(_filled(feature.without, i) for i, feature in enumerate(features))
    first, *beside = phrases
    together = f"{first} beside {' and '.join(beside)}" if beside else first
    together = together.removesuffix(",")
    message, remedy = form.replace("{}", together), ", or ".join(ways)
    message += f", because {because}" if because else ""
    return Row(features[0].at, find, message, remedy, features=features)


def find_faults(checks: Sequence[Row[Any]], said: object) -> list[dict[str, Any]]:
    """Return the faults that a table of checks finds."""
    return [error.context or {} for check in checks for error in check.faults(said)]


def run_checks(checks: Sequence[Row[Any]], said: object) -> None:
    """Raise the faults that a table of checks finds, all of them as one error."""
    if found := find_faults(checks, said):
        raise as_error(found)


def exclusive(one: str, other: str) -> Row[Any]:
    """Return the check that at most one of two keys is given."""
    return Row(
        other,
        lambda s: getattr(s, one) is not None and getattr(s, other) is not None,
        f"{one} and {other} exclude each other",
        "keep one of them",
    )


def exactly_one(ways: dict[str, str]) -> tuple[Row[Any], ...]:
    """Return the checks that just one of two keys is given."""
    one, other = ways
    return (
        Row(
            "",
            lambda s: getattr(s, one) is None and getattr(s, other) is None,
            f"neither {one} nor {other} is given",
            f"add `{ways[one]}` or `{ways[other]}`",
        ),
        exclusive(one, other),
    )


@dataclass(frozen=True, slots=True)
class Reference:
    """A name in a spec that refers to another part, and the existing names."""

    noun: str
    name: str
    choices: Collection[str]

    def is_lost(self) -> tuple[str, str] | None:
        """Return the name and what may be meant, if there is no such name."""
        if self.name in self.choices:
            return None
        return quoted(self.name), did_you_mean(self.name, self.choices)


NO_SUCH = Row[Reference]("", Reference.is_lost, "there is no {s.noun} {0}", "{1}")
