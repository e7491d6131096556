"""How a sampled loop loses contact: not at all, where the tissue ends, or at any deflection."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.models.contact.environment import Environment


class Loss(Enum):
    """Where contact is lost, by the id of the sentence that says so."""

    NEVER = "contact-kept.never"
    NOT_MODELLED = "contact-kept.not-modelled"
    # What each law takes for granted.
    BY_LAWS = "contact-kept.law"
    # Where the spring of the tissue ends; a statement that covers it says so.
    SURFACE = "contact-lost.surface"
    ANYWHERE = "contact-lost.anywhere"
    UNDER_FORCE_CONTROL = "contact-lost.force-control"

    @property
    def anywhere(self) -> bool:
        """Whether it is lost at any deflection, and free motion is a mode among others."""
        return self in (Loss.ANYWHERE, Loss.UNDER_FORCE_CONTROL)

    @classmethod
    def of(
        cls,
        contact: str | None,
        environments: Iterable[Environment],
        design: ControllerDesign,
        *,
        slowed: bool,
    ) -> Loss:
        """Tell how contact is lost, by the key `contact` of a spec.

        With springs everywhere free motion is a mode like others. A motor that is `slowed` by what
        it touches would lose it within a period, too, which has to be asked for.
        """
        if any(c.law.commands == "position" for c in design.controllers):
            # Force control rests in the air where it does in contact: at what is commanded.
            return cls.UNDER_FORCE_CONTROL if contact == "losable" else cls.BY_LAWS
        sprung = {c.law.spring != 0 for c in design.controllers}
        if contact == "kept" or ((slowed or True in sprung) and contact is None):
            return cls.NEVER
        if any(
            e.preloaded or e.law.remembers or (e.parts and not e.each_losable) for e in environments
        ):
            return cls.NOT_MODELLED
        return cls.ANYWHERE if sprung == {True} else cls.SURFACE
