"""Names in a spec that lead to another part of it."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from nrs_design.proof.text import quoted
from nrs_design.spec.check import Row
from nrs_design.spec.faults import did_you_mean


@dataclass(frozen=True, slots=True)
class Reference:
    """A name, and those that there are."""

    noun: str
    name: str
    choices: Collection[str]

    def is_lost(self) -> tuple[str, str] | None:
        """Return the name and what may be meant, if there is no such name."""
        if self.name in self.choices:
            return None
        return quoted(self.name), did_you_mean(self.name, self.choices)


NO_SUCH = Row[Reference]("", Reference.is_lost, "there is no {s.noun} {0}", "{1}")
