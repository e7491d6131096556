"""Position control of the hybrid scheme (thesis 6.3.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.controllers.laws.law import AbstractCompliantLaw, DiscreteLaw, Response
from nrs_design.models.linear_form import LinearForm, zero
from nrs_design.spec.controllers import Command, PositionControllerSpec


@dataclass(frozen=True, slots=True)
class PositionControl(AbstractCompliantLaw[PositionControllerSpec]):
    """The position mode: the motion loop follows its command, whatever the force."""

    name: ClassVar[str] = "position"
    units: ClassVar[Mapping[str, str]] = {}
    commands: ClassVar[Command] = PositionControllerSpec.commands
    # Free motion is this very mode.
    contact_kept: ClassVar[str | None] = None

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return no correction."""
        return zero(len(force)), []

    def discretize(self, period: Fraction, method: str) -> DiscreteLaw:
        """Return the law without numbers: it takes no force."""
        return DiscreteLaw(type(self), {})


LAW = PositionControl
