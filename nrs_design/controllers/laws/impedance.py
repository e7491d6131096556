"""Impedance control: the force on the robot corrects its velocity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from types import MappingProxyType
from typing import ClassVar

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws.law import AbstractCompliantLaw, Response
from nrs_design.controllers.sampled import SampledAdmittance
from nrs_design.models.linear_form import LinearForm, combine
from nrs_design.proof.taylor import exponential_between
from nrs_design.spec.controllers import Command, ImpedanceControllerSpec

KEPT_VELOCITY = (
    "While a gain changes, the admittance keeps its velocity vm: the controller integrates "
    "vm' = (F - Bt vm)/Mt with the gains of the moment. One that keeps Mt vm, or another memory of "
    "a filter, is not covered."
)
STATIC_LAW = (
    "With Mt = 0 the admittance has no memory: its velocity is F/Bt with the Bt of the moment, and "
    "jumps with it."
)


@dataclass(frozen=True, slots=True)
class Admittance(AbstractCompliantLaw[ImpedanceControllerSpec]):
    """Velocity correction ``vm = F / (Mt s + Bt)`` (thesis 6.8), subtracted from the command.

    Parameters
    ----------
    Mt : Fraction
        Virtual inertia in kg m^2; zero makes the law static.
    Bt : Fraction
        Virtual damping in N m s/rad; positive.
    """

    name: ClassVar[str] = "impedance"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({"Mt": "kg*m^2", "Bt": "N*m*s/rad"})
    commands: ClassVar[Command] = ImpedanceControllerSpec.commands

    Mt: Fraction
    Bt: Fraction

    @property
    def states(self) -> tuple[str, ...]:
        """The velocity; none without inertia."""
        return ("vm [rad/s]",) if self.Mt else ()

    @property
    def state_words(self) -> tuple[str, ...]:
        """The velocity in words; none without inertia."""
        return ("the velocity vm",) if self.Mt else ()

    @property
    def inverse(self) -> frozenset[str]:
        """With inertia the loop is affine in 1/Mt and Bt, without it in 1/Bt."""
        return frozenset({"Mt" if self.Mt else "Bt"})

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Return ``-vm``, with ``Mt vm' = F - Bt vm``; without inertia ``vm = F / Bt``."""
        if self.Mt == 0:
            return combine((-1 / self.Bt, force)), []
        (vm,) = states
        rate = combine((1 / self.Mt, force), (-self.Bt / self.Mt, vm))
        return combine((Fraction(-1), vm)), [rate]

    def sampled(self, period: Fraction, method: str) -> SampledAdmittance:
        """Discretize ``Mt v' + Bt v = F`` (thesis 6.8).

        Exactly for a force that is held: ``a = exp(-Bt T/Mt)`` and ``b = (1 - a)/Bt``; or by
        Euler's method: ``a = 1 - Bt T/Mt`` and ``b = T/Mt``.
        """
        T = to_float32(period)
        if self.Mt == 0:
            return SampledAdmittance(None, to_float32(1 / self.Bt), T)
        step = self.Bt * period / self.Mt
        if method == "euler":
            return SampledAdmittance(to_float32(1 - step), to_float32(period / self.Mt), T)
        a, _ = exponential_between(-step)
        return SampledAdmittance(to_float32(a), to_float32((1 - a) / self.Bt), T)

    @classmethod
    def contact_text(cls, *, alone: bool) -> str:
        """Say that contact is not lost."""
        if alone:
            return "Contact is not lost: free motion is not one of the modes."
        return (
            "Contact is not lost while an impedance controller is active: free motion under one is "
            "not one of the modes."
        )

    @property
    def retuned_text(self) -> str:
        """Say what the controller keeps while its gains change."""
        return KEPT_VELOCITY if self.Mt else STATIC_LAW
