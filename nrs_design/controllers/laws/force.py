"""Force control of the hybrid scheme (thesis 6.3.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import ClassVar

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws.law import AbstractCompliantLaw, Response
from nrs_design.controllers.sampled import SampledForce
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.spec.controllers import Command, ForceControllerSpec


@dataclass(frozen=True, slots=True)
class ProportionalForce(AbstractCompliantLaw[ForceControllerSpec]):
    """Position correction ``Kp (Fd - F)`` of the force mode (thesis 6.32)."""

    name: ClassVar[str] = "force"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({"Kp": "rad/(N*m)"})
    commands: ClassVar[Command] = ForceControllerSpec.commands
    holds_hand: ClassVar[bool] = True

    Kp: Fraction  # In rad/(N m)

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``-Kp F``: in contact with a spring ``A = Ap - Bp Kp k Cp`` (thesis 6.46)."""
        return combine((-self.Kp, force)), []

    def sampled(self, period: Fraction, method: str) -> SampledForce:
        """Return the gain: the law has no memory."""
        return SampledForce(self.Kp)

    def find_fault(self, given: ForceControllerSpec) -> str | None:
        """Say if the gain is negative, or another one than the spec fixes."""
        fixed = given.proportional_gain
        if self.Kp < 0 or (fixed is not None and self.Kp != to_float32(fixed.exact)):
            return "gain Kp is not what the spec fixes"
        return None

    @classmethod
    def contact_text(cls, *, alone: bool) -> str:
        """Say that contact is not lost."""
        return (
            "Contact is not lost while force is controlled: the environment would pull as it "
            "pushes."
        )
