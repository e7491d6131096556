"""Contact loss of a sampled loop: none, at the surface, or at any deflection."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.models.contact.environment import Environment


class Loss(Enum):
    """Place of contact loss, by the id of its assumption."""

    NEVER = "contact-kept.never"
    NOT_MODELLED = "contact-kept.not-modelled"
    # Each law states its own assumption.
    BY_LAWS = "contact-kept.law"
    # At the surface; each statement says whether it covers the loss.
    SURFACE = "contact-lost.surface"
    ANYWHERE = "contact-lost.anywhere"
    UNDER_FORCE_CONTROL = "contact-lost.force-control"

    @property
    def anywhere(self) -> bool:
        """Whether contact is lost at any deflection, so that free motion is one of the modes."""
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
            # Force control has the same equilibrium in free motion: the commanded position.
            return cls.UNDER_FORCE_CONTROL if contact == "losable" else cls.BY_LAWS
        sprung = {c.law.spring != 0 for c in design.controllers}
        if contact == "kept" or ((slowed or True in sprung) and contact is None):
            return cls.NEVER
        if any(
            e.preloaded or e.law.remembers or (e.parts and not e.each_losable) for e in environments
        ):
            return cls.NOT_MODELLED
        return cls.ANYWHERE if sprung == {True} else cls.SURFACE
