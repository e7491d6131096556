"""A value of a constant parameter at which the system is not stable: simulated there."""

from __future__ import annotations

from typing import Any

from nrs_design.proof.constant import system_at
from nrs_design.proof.evidence import UnstableValue
from nrs_design.proof.evidence.unstable_value import value_text
from nrs_design.reporting.document import Paragraph, Section
from nrs_design.reporting.kinds.abstract import AbstractKindPage


class UnstableValuePage(AbstractKindPage[UnstableValue]):
    """The page of what is unstable, at that value of the parameter."""

    @property
    def name(self) -> str:
        """What it shows."""
        return "a value of the parameter that is not stable"

    def meaning(self) -> tuple[str, ...]:
        """Say why one value is enough, and what happens there."""
        return (
            "The parameter is unknown and constant, so it may have this one value all the time. "
            "The matrices at this value are computed exactly.",
            *self._part.meaning(),
        )

    def limits(self) -> tuple[str, ...]:
        """Say that nothing follows for other values."""
        return (
            *self._part.limits(),
            "Nothing is said about other values of the parameter: a narrower range may be stable.",
        )

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Show nothing beside the run."""
        return ()

    def run(self) -> Section:
        """Draw the run of the part at this value."""
        text = (
            f"{value_text(self.system, self.evidence.share)}: what follows is simulated at this "
            "value of the parameter, between the modes that are listed."
        )
        run = self._part.run()
        return Section(run.title, (Paragraph(text), *run.blocks))

    @property
    def _part(self) -> AbstractKindPage[Any]:
        # Imported here, as the table names this file too.
        from nrs_design.reporting.kinds import page_of

        return page_of(system_at(self.system, self.evidence.share), self.evidence.part)
