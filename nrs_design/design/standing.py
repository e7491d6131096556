"""How a goal for a margin or an error stands."""

from __future__ import annotations

from enum import StrEnum


class Standing(StrEnum):
    """How a goal stands."""

    MET = "met"
    NOT_JUDGED = "not judged"  # Nothing in the ranges was found to miss it, nor is it proved there
    MISSED = "missed"

    @property
    def text(self) -> str:
        """The same for people."""
        return "MISSED" if self is Standing.MISSED else str(self)
