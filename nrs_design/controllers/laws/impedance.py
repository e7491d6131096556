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

    With a spring it is ``vm = F / (Mt s + Bt + Kt/s)`` (thesis 2.2.6.2): the spring acts on the
    integral of vm, which is by how much the position reference has been moved.
    """

    name: ClassVar[str] = "impedance"
    units: ClassVar[Mapping[str, str]] = MappingProxyType(
        {"Mt": "kg*m^2", "Bt": "N*m*s/rad", "Kt": "N*m/rad"}
    )
    commands: ClassVar[Command] = ImpedanceControllerSpec.commands

    Mt: Fraction  # Virtual inertia in kg m^2; zero makes the law static
    Bt: Fraction  # Virtual damping in N m s/rad; positive
    # Virtual stiffness in N m/rad; zero is no spring, and then no gain of the law.
    Kt: Fraction = Fraction(0)

    @property
    def gains(self) -> Mapping[str, Fraction]:
        """The gains by name; the spring only where there is one."""
        found = {"Mt": self.Mt, "Bt": self.Bt}
        return found | {"Kt": self.Kt} if self.Kt else found

    @classmethod
    def of(cls, gains: Mapping[str, Fraction]) -> Admittance:
        """Return the law with these gains; without Kt it has no spring."""
        return cls(gains["Mt"], gains["Bt"], gains.get("Kt", Fraction(0)))

    @classmethod
    def gains_in(cls, given: ImpedanceControllerSpec) -> tuple[str, ...]:
        """Return the names of its gains; Kt is one where the spec gives it."""
        return ("Mt", "Bt") if given.Kt is None else ("Mt", "Bt", "Kt")

    @property
    def spring(self) -> Fraction:
        """The virtual stiffness."""
        return self.Kt

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
        """Return ``-vm``, with ``Mt vm' = F - Bt vm``; without inertia ``vm = F / Bt``.

        The force F has that of the spring in it, -Kt q.
        """
        if self.Mt == 0:
            return combine((-1 / self.Bt, force)), []
        (vm,) = states
        rate = combine((1 / self.Mt, force), (-self.Bt / self.Mt, vm))
        return combine((Fraction(-1), vm)), [rate]

    def sampled(self, period: Fraction, method: str) -> SampledAdmittance:
        """Discretize ``Mt v' + Bt v = F`` (thesis 6.8).

        Exactly for a force that is held: ``a = exp(-Bt T/Mt)`` and ``b = (1 - a)/Bt``; or by
        Euler's method: ``a = 1 - Bt T/Mt`` and ``b = T/Mt``. The spring's force counts as part of
        the force.
        """
        T = to_float32(period)
        if self.Mt == 0:
            return SampledAdmittance(None, to_float32(1 / self.Bt), T, self.Kt)
        step = self.Bt * period / self.Mt
        if method == "euler":
            return SampledAdmittance(to_float32(1 - step), to_float32(period / self.Mt), T, self.Kt)
        a, _ = exponential_between(-step)
        return SampledAdmittance(to_float32(a), to_float32((1 - a) / self.Bt), T, self.Kt)

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
