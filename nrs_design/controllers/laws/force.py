"""Force control of the hybrid scheme (thesis 6.3.3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.controllers.laws.law import AbstractCompliantLaw, DiscreteLaw, Response
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.spec.controllers import Command, ForceControllerSpec


@dataclass(frozen=True, slots=True)
class ProportionalForce(AbstractCompliantLaw[ForceControllerSpec]):
    """Position correction ``Kp (Fd - F)`` of the force mode (thesis 6.32)."""

    name: ClassVar[str] = "force"
    sentences: ClassVar[Mapping[str, str]] = {
        "contact-kept.force": (
            "Contact is not lost while force is controlled: the environment "
            "would pull as it pushes."
        ),
    }
    units: ClassVar[Mapping[str, str]] = {"Kp": "rad/(N*m)"}
    commands: ClassVar[Command] = ForceControllerSpec.commands
    fixed: ClassVar[Mapping[str, str]] = {"Kp": "proportional_gain"}
    holds_hand: ClassVar[bool] = True
    contact_kept: ClassVar[str | None] = "force"

    Kp: Fraction  # In rad/(N m)

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``-Kp F``: in contact with a spring ``A = Ap - Bp Kp k Cp`` (thesis 6.46)."""
        return combine((-self.Kp, force)), []

    def discretize(self, period: Fraction, method: str) -> DiscreteLaw:
        """Return the gain: the law has no memory."""
        return DiscreteLaw(type(self), {"Kf": self.Kp} if self.Kp else {})

    def find_fault(self, spec: ForceControllerSpec) -> str | None:
        """Return the fault of a negative gain, or of a gain unlike the spec."""
        negative = "gain Kp is negative" if self.Kp < 0 else None
        return AbstractCompliantLaw.find_fault(self, spec) or negative


LAW = ProportionalForce
