"""What a page says and draws of one kind of evidence."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Generic, TypeVar

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Section
from nrs_design.simulation.norms import Array

E = TypeVar("E", bound=AbstractEvidence)


@dataclass(frozen=True)
class AbstractKindPage(ABC, Generic[E]):
    """One statement for the reader: in a few words, in sentences, in numbers and as a run."""

    system: SwitchedSystem  # What it is about
    evidence: E  # The statement. Its claim is its own and is not repeated by a page.

    @property
    @abstractmethod
    def name(self) -> str:
        """What it is, in a few words, for a table."""

    @abstractmethod
    def meaning(self) -> tuple[str, ...]:
        """Say what the claim means, on what it rests, and how it was decided."""

    def between_corners(self) -> tuple[str, ...]:
        """Say whether values between the corners of declared ranges are covered.

        Nothing by default: no proof, no question.
        """
        return ()

    @abstractmethod
    def limits(self) -> tuple[str, ...]:
        """Say what does not follow."""

    @abstractmethod
    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show its numbers in tables and figures; nothing if the run shows all there is.

        Parameters
        ----------
        first : bool
            No earlier statement of the report is of this kind. What would be drawn again is left
            out of the others.
        """

    def quadratic(self) -> tuple[Array, float] | None:
        """Return Q and a rate at which its norm decays from the first moment, if there is one."""
        return None

    @abstractmethod
    def run(self) -> Section:
        """Simulate a run, below the proved bound or as a witness of instability."""
