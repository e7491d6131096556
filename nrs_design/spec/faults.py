"""Faults of a spec: how a reader or a check reports them, without a place in a file yet."""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection, Sequence
from itertools import islice
from typing import Any, TypeVar

from pydantic_core import PydanticCustomError

from nrs_design.errors import SpecError

Location = tuple[int | str, ...]
_T = TypeVar("_T")

MAX_LISTED = 20
# The type of error by which validation knows them.
FAULT = "spec_fault"


def fault(message: str, remedy: str, *at: int | str) -> PydanticCustomError:
    """Build the exception by which a validator reports a fault, and where below its value."""
    context = {"message": message, "remedy": remedy, "at": at}
    return PydanticCustomError(FAULT, "{message}", context)


def as_text(value: object, *at: int | str) -> str:
    """Return the value if it is a single text, and report a fault otherwise."""
    if not isinstance(value, str):
        raise fault("expected a single value, not a list or a mapping", "write one value", *at)
    return value


def reported(read: Callable[[], _T], *at: int | str) -> _T:
    """Call a reader, and report its SpecError as a fault at the given place."""
    try:
        return read()
    except SpecError as error:
        raise fault(error.message, error.remedy or "", *at) from None


def all_of(*reads: Callable[[], _T]) -> list[_T]:
    """Call every reader or check, and report the faults of all of them, not of the first only."""
    results: list[_T] = []
    found: list[dict[str, Any]] = []
    for read in reads:
        try:
            results.append(read())
        except PydanticCustomError as error:
            context = error.context or {}
            found += context.get("all", [context])
    if found:
        raise as_error(found)
    return results


def as_error(found: list[dict[str, Any]]) -> PydanticCustomError:
    """Return several faults, at least one, as one error; each is the context of an error."""
    return PydanticCustomError(FAULT, "{message}", {**found[0], "all": found})


def nearest(word: str, choices: Collection[str], called: Sequence[str] = ()) -> str | None:
    """Return the choice that a mistyped word means; `called` are choices with another such name."""
    alike = [choice for choice in choices if choice.lower() == word.lower()]
    # A mistyped word keeps its first letter: `coupling` is not `sampling`.
    begun = [choice for choice in choices if choice[:1].lower() == word[:1].lower()]
    near = alike or called or difflib.get_close_matches(word, begun, n=1)
    return near[0] if near else None


def did_you_mean(
    word: str,
    choices: Collection[str],
    noun: str = "write one of",
    called: Sequence[str] = (),
) -> str:
    """Suggest the nearest choice, and list them all if they are few.

    `noun` begins the list; `called` are choices that are called so elsewhere.
    """
    if not choices:
        return "there is none yet: add it"
    near = nearest(word, choices, called)
    more = ", ..." * (len(choices) > MAX_LISTED)
    listing = f"{noun} {', '.join(islice(choices, MAX_LISTED))}{more}"
    return f"did you mean {near}? {listing}" if near else listing
