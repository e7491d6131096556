"""The page of one statement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from nrs_design.reporting.document import Section


@dataclass(frozen=True)
class Page:
    """Name, meaning, limits, tables and simulated run of one statement.

    The claim is that of the evidence, and no page repeats it.
    """

    name: str  # What it is, in a few words, for a table
    meaning: tuple[str, ...]  # What the claim means, what it rests on, and how it was decided
    limits: tuple[str, ...]  # What does not follow, beside what the meaning says of it
    run: Callable[[], Section]  # Below the proved bound, or a witness of instability
    sections: Callable[[], tuple[Section, ...]] = tuple  # The numbers in tables
    changing: str = "however fast they change"  # Which values between corners are covered
