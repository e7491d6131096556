"""Motion control: the loop below all compliant controllers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws.law import AbstractLaw


@dataclass(frozen=True, slots=True)
class ProportionalDerivative(AbstractLaw):
    """Motion control ``delta = Kp e + Kd e'`` (thesis 4.3), e in rad, delta a command."""

    name: ClassVar[str] = "motion"
    units: ClassVar[Mapping[str, str]] = {"Kp": "rpm/rad", "Kd": "rpm*s/rad"}

    Kp: Fraction  # In rpm/rad, or whatever the motor takes instead of rpm
    Kd: Fraction  # In rpm s/rad, likewise

    @property
    def gains(self) -> Mapping[str, Fraction]:
        """The gains by name; none where the robot closes its own motion loop."""
        return {} if self.absent else {"Kp": self.Kp, "Kd": self.Kd}

    @property
    def absent(self) -> bool:
        """Whether the robot closes the motion loop, and takes velocities."""
        return self.Kp == self.Kd == 0

    @property
    def zero(self) -> Fraction:
        """The z of ``Kd (s + z)``, in 1/s."""
        return self.Kp / self.Kd

    def difference_gain(self, period: Fraction) -> Fraction:
        """Return Kd over a period in s: what multiplies the change of the error in a sample."""
        return round_float32(self.Kd / period)


# Gains of a robot with a motion loop inside.
NO_MOTION = ProportionalDerivative(Fraction(0), Fraction(0))
