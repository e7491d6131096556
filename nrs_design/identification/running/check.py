"""The nouns of a judgement."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Self


class BoundStatus(StrEnum):
    """How a run stands to one bound."""

    INSIDE = "inside"
    OUTSIDE = "outside"
    # It may be either: intervals lie across the bound.
    UNDECIDED = "undecided"
    NOT_JUDGED = "not judged"
    # The proof assumes that there is none of it, and has no bound.
    NOT_MODELLED = "not modelled"


@dataclass(frozen=True, slots=True)
class Violation:
    """Where a run first left a bound."""

    time: float  # In s, as in the log
    words: str  # What happened


@dataclass(frozen=True, slots=True)
class Check:
    """One bound and what the run says about it."""

    name: str  # What is judged
    status: BoundStatus  # The outcome
    measured: str  # What the log shows; for what is not judged, why
    allowed: str = ""  # The bound
    basis: str = ""  # Where the bound comes from
    first: Violation | None = None  # The first time it was left

    @classmethod
    def open(cls, name: str, why: str, allowed: str = "", basis: str = "") -> Self:
        """Return a check that is not judged."""
        return cls(name, BoundStatus.NOT_JUDGED, why, allowed, basis)
