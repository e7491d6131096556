"""A theorem for Coq: definitions, computation, statement and proof."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from nrs_design.exporters.proof_assistant.text import Definitions, identifiers, listed
from nrs_design.proof.evidence.graph import FormsOnGraph
from nrs_design.proof.mode import Mode
from nrs_design.proof.system import SwitchedSystem


@dataclass(frozen=True)
class AbstractStatement(ABC):
    """A system and its forms; the first state is the deflection where contact is lost."""

    system: SwitchedSystem
    evidence: FormsOnGraph

    @property
    def lost(self) -> bool:
        """Whether contact is lost and made again."""
        return self.evidence.covers_lost_contact

    @property
    def order(self) -> list[int]:
        """The states as they come."""
        *others, last = range(self.system.order)
        return [last, *others] if self.lost else [*others, last]

    @abstractmethod
    def mode(self, k: int, mode: Mode, definitions: Definitions) -> str:
        """Return the text of the k-th mode; those of free motion come after those in contact."""

    def define_modes(self, definitions: Definitions) -> tuple[str, str]:
        """Define every mode; return those in contact, and those of free motion."""
        touching, flying = self.system.modes, self.system.free if self.lost else ()
        names = identifiers(mode.name for mode in (*touching, *flying))
        for k, mode in enumerate((*touching, *flying)):
            definitions.define(names[mode.name], self.mode(k, mode, definitions), mode.name)
        each = (listed(names[mode.name] for mode in part) for part in (touching, flying))
        return next(each), next(each)


@dataclass(frozen=True, slots=True)
class Theorem:
    """The text of a file, but for its head."""

    library: tuple[str, ...]  # Parts of the library, in order
    definitions: Sequence[str]  # The system and the certificate
    check: str  # What must be computed to be true
    statement: str  # The theorem
    proof: str  # A term, with `checked` for what was computed
    states: tuple[str, ...]  # In the order in which it counts them
    left_out: tuple[str, ...] = ()  # What the statement leaves out against the claim
