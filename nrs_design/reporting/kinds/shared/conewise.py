"""What every function for contact and free motion means, whatever its form."""

from __future__ import annotations

from typing import ClassVar, TypeVar

from nrs_design.proof.evidence import AbstractEvidence
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words

E = TypeVar("E", bound=AbstractEvidence)

MOVED_REST = (
    "A force reference or a velocity command that pushes into the environment: they move the point "
    "of rest, and the bound is about the point of rest without them."
)
_MEASURED = (
    "So it measures motion, force and penetration, and not how far the axis has moved away from "
    "the surface: once it has come to rest in the air, it stays there."
)


class AbstractConewisePage(AbstractKindPage[E]):
    """A page about a function of all states in contact, without the deflection in free motion."""

    function: ClassVar[str]
    """What it is, in contact and in free motion."""

    decided: ClassVar[str]
    """What integer arithmetic decides about it."""

    def meaning(self) -> tuple[str, ...]:
        """Say what is measured, and that no rule of switching is needed."""
        return (
            f"{self.function} {_MEASURED}",
            words.free_bound(self.system),
            *words.unneeded_rules(self.system),
            words.decision(self.decided),
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say what a constant force or command would change."""
        return (MOVED_REST,)
