"""PI force control beside other controllers, with an integral that bleeds while they are active.

The thesis takes a PI for impossible under switching "due to the integral term" (6.3.3). It is
possible where two things are said of the integral w. In contact under force control it integrates
without a leak, so no force error is left. While another controller is active it decays, ``w' = -g
w``, and stays in the command meanwhile: so the command does not jump by w at a switch, in either
direction.
"""

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
from nrs_design.spec.controllers import Command, IntegralControllerSpec


@dataclass(frozen=True, slots=True)
class IntegralForce(AbstractCompliantLaw[IntegralControllerSpec]):
    """Position correction ``Kp (Fd - F) + w`` with ``w' = Ki (Fd - F)``."""

    name: ClassVar[str] = "pi-force"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({"Kp": "rad/(N*m)", "Ki": "rad/(N*m*s)"})
    commands: ClassVar[Command] = IntegralControllerSpec.commands
    holds_hand: ClassVar[bool] = True
    bleeds: ClassVar[bool] = IntegralControllerSpec.bleeds

    Kp: Fraction  # In rad/(N m)
    Ki: Fraction  # In rad/(N m s)

    @property
    def states(self) -> tuple[str, ...]:
        """The integral of the force error."""
        return ("integral [rad]",)

    @property
    def state_words(self) -> tuple[str, ...]:
        """The integral in words."""
        return ("the integral of the force error",)

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``w - Kp F``, with ``w' = -Ki F``."""
        (w,) = states
        return combine((Fraction(1), w), (-self.Kp, force)), [combine((-self.Ki, force))]

    def sampled(self, period: Fraction, method: str) -> SampledForce:
        """Integrate by Euler's method, ``w+ = w + Ki T (Fd - F)``, with Ki T rounded once."""
        return SampledForce(self.Kp, to_float32(self.Ki * period))

    def find_fault(self, given: IntegralControllerSpec) -> str | None:
        """Say if the gains are not positive, or others than the spec fixes."""
        if self.Kp <= 0 or self.Ki <= 0:
            return "gains Kp and Ki are not positive"
        Kp, Ki = given.proportional_gain, given.integral_gain
        if Kp is not None and self.Kp != to_float32(Kp.exact):
            return "gain Kp is not what the spec fixes"
        if Ki is not None and self.Ki != to_float32(Ki.exact):
            return "gain Ki is not what the spec fixes"
        return None

    @classmethod
    def contact_text(cls, *, alone: bool) -> str:
        """Say that contact is not lost."""
        return (
            "Contact is not lost under PI force control: without a force the integral is driven by "
            "the wanted force alone, and the axis moves on until it meets something."
        )
