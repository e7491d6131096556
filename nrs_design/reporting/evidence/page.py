"""The page of one statement."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Section
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.offers import Offer
from nrs_design.simulation.norms import Array


@dataclass(frozen=True)
class AbstractPage(ABC):
    """Name, meaning, limits, tables and simulated run of one statement.

    The claim is that of the evidence, and no page repeats it.
    """

    system: SwitchedSystem
    evidence: AbstractEvidence
    offer: Offer

    @property
    @abstractmethod
    def name(self) -> str:
        """What it is, in a few words, for a table."""

    @abstractmethod
    def meaning(self) -> tuple[str, ...]:
        """Say what the claim means, what it rests on, and how it was decided."""

    def between_corners(self) -> str:
        """Say of a proof that values between the corners of declared ranges are covered."""
        return words.all_corners(self.system, self.evidence)

    def limits(self) -> tuple[str, ...]:
        """Say what does not follow, beside what the meaning says of it."""
        return ()

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show the numbers in tables and figures; by default none beside the run.

        `first`: no earlier statement is of this kind; others leave out what would be drawn again.
        """
        return ()

    def quadratic(self) -> tuple[Array, float] | None:
        """Return Q and the rate at which its norm decays from the first moment, if there is one."""
        return None

    @abstractmethod
    def run(self) -> Section:
        """Simulate a run: below the proved bound, or a witness of instability."""

    @property
    def is_discrete(self) -> bool:
        """Whether the system moves in steps."""
        return self.system.time is Time.DISCRETE
