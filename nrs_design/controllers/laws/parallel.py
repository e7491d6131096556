"""Parallel position and force control (thesis 2.2.6.4, after Chiaverini and Sciavicco 1988)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import ClassVar

from nrs_design.controllers.laws.law import AbstractCompliantLaw, Response
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.spec.controllers import Command, ParallelControllerSpec


@dataclass(frozen=True, slots=True)
class ParallelForce(AbstractCompliantLaw[ParallelControllerSpec]):
    """Position command plus a PI of the force error, ``Xc + Kp (Fd - F) + w``."""

    name: ClassVar[str] = "parallel"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({"Kp": "rad/(N*m)", "Ki": "rad/(N*m*s)"})
    commands: ClassVar[Command] = ParallelControllerSpec.commands
    fixed: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"Kp": "proportional_gain", "Ki": "integral_gain"}
    )

    Kp: Fraction  # In rad/(N m)
    Ki: Fraction  # In rad/(N m s): ``w' = Ki (Fd - F)``

    @property
    def states(self) -> tuple[str, ...]:
        """The integral of the force error."""
        return ("w [rad]",)

    @property
    def state_words(self) -> tuple[str, ...]:
        """The integral in words."""
        return ("the integral w of the force error",)

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``w - Kp F``, with ``w' = -Ki F``."""
        (w,) = states
        return combine((Fraction(1), w), (-self.Kp, force)), [combine((-self.Ki, force))]

    @classmethod
    def contact_text(cls, *, alone: bool) -> str:
        """Say that contact is not lost."""
        return (
            "Contact is not lost under parallel control: without a force its integral is driven by "
            "the wanted force alone, and the axis moves on until it meets something."
        )


LAW = ParallelForce
