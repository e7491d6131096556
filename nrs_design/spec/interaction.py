"""The spec of an interaction design: one robot, its environments and its controllers."""

from __future__ import annotations

from collections.abc import Callable

from pydantic import model_validator

from nrs_design.spec.faults import all_of
from nrs_design.spec.interaction_checks import checks_across
from nrs_design.spec.interaction_parts import AbstractInteractionSpec


class InteractionDesignSpec(AbstractInteractionSpec):
    """Controllers to be designed for the contact with given environments."""

    def across(self) -> tuple[Callable[[], object], ...]:
        """Return the checks between parts: contacts, goals, disturbances, the motor, switching."""
        return checks_across(self)

    @model_validator(mode="after")
    def _check_across(self) -> InteractionDesignSpec:
        all_of(*self.across())
        return self
