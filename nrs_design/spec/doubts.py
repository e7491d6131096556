"""Reasons to doubt a spec that is valid: warnings, not errors."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from nrs_design.spec.check import find_faults
from nrs_design.spec.plausible import doubt_sizes

if TYPE_CHECKING:
    from nrs_design.spec.load import Spec


@dataclass(frozen=True, slots=True)
class Doubt:
    """Something that is allowed, and probably not meant."""

    at: tuple[str, ...]  # Keys that lead to it in the spec
    message: str  # What is doubtful; one line
    # A value of the design over its limit: how useless it makes the design; 0 where it has none.
    beyond: float = 0.0

    def __str__(self) -> str:
        """Return the message."""
        return self.message


def doubt_spec(spec: Spec) -> Iterator[Doubt]:
    """Yield what is doubtful about a spec, before anything is designed."""
    yield from (Doubt(at, text) for at, text in doubt_sizes(spec))
    for found in find_faults(spec.warnings, spec, spec.checks):
        yield Doubt(found["at"], f"{found['message']} ({found['remedy']})")


def worst_first(doubts: Iterable[Doubt]) -> tuple[Doubt, ...]:
    """Return doubts by how far they are beyond a limit, else in their order."""
    return tuple(sorted(doubts, key=lambda doubt: -doubt.beyond))
