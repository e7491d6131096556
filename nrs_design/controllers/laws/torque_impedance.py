"""Impedance control of a robot that takes torques: a spring and a damper to a position."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws.law import AbstractCompliantLaw, DiscreteLaw, Response
from nrs_design.controllers.parts import FORCE_GAIN, POSITION, StepGain, StepPart
from nrs_design.errors import DesignError
from nrs_design.models.linear_form import LinearForm
from nrs_design.spec.controllers import Command, TorqueImpedanceSpec


@dataclass(frozen=True, slots=True)
class TorqueImpedance(AbstractCompliantLaw[TorqueImpedanceSpec]):
    """Torque ``u = (K e + D e')/R - (1/R - 1) F`` at the joint (thesis 2.2.6.1).

    With the joint ``J theta'' = u - F`` that is ``R J theta'' = K e + D e' - F``: the joint moves
    as one of R times its inertia on a spring K and a damper D. With R = 1 no force is needed.
    """

    name: ClassVar[str] = "torque-impedance"
    units: ClassVar[Mapping[str, str]] = {"K": "N*m/rad", "D": "N*m*s/rad", "R": "1"}
    commands: ClassVar[Command] = TorqueImpedanceSpec.commands
    fixed: ClassVar[Mapping[str, str]] = {"K": "stiffness", "D": "damping", "R": "inertia_ratio"}

    K: Fraction  # In N m/rad
    D: Fraction  # In N m s/rad
    R: Fraction = Fraction(1)  # Wanted inertia over that of the joint; 1 is no gain of the law

    @classmethod
    def gain_names(cls, spec: TorqueImpedanceSpec) -> tuple[str, ...]:
        """Return the gain names: K and D, with R if the spec scales the inertia."""
        return ("K", "D") if spec.inertia_ratio in (None, 1) else ("K", "D", "R")

    def respond(self, force: LinearForm, states: Sequence[LinearForm]) -> Response:
        """Refuse: a robot that takes torques is modelled in the sampled loop alone."""
        raise DesignError(
            "a law that makes torques has no form in continuous time here",
            remedy="use what is about the sampled loop, such as --engine sampled or --format json",
        )

    def discretize(self, period: Fraction, method: str) -> DiscreteLaw:
        """Return ``Kp = K/R``, ``D/(R T)`` and the share of the force, ``1/R - 1``."""
        numbers = {"Kp": round_float32(self.K / self.R)}
        if self.D:
            numbers["Kd_over_T"] = round_float32(self.D / (self.R * period))
        if self.R != 1:
            # Contact brakes with F; the law makes F/R of it.
            numbers[FORCE_GAIN] = round_float32(1 / self.R - 1)
        return DiscreteLaw(type(self), numbers)

    @classmethod
    def parts(cls, number_names: Collection[str], *, has_position: bool) -> tuple[StepPart, ...]:
        """Return the gains of the motion controller, which are its own; and that of the force."""
        force = (StepGain(FORCE_GAIN, "Kf", "1"),) if FORCE_GAIN in number_names else ()
        gains = (StepGain("Kp", "Kp", "N*m/rad"), StepGain("Kd_over_T", "D", "N*m/rad"), *force)
        return (StepPart("torque", gains, (POSITION,)),)


LAW = TorqueImpedance
