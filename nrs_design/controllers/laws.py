"""The control laws that run on the robot, one axis each, with the gains that ship.

All gains are exact rationals that are single-precision numbers, so that a proof, a simulation
and an export speak about the same values.
"""

from __future__ import annotations

from abc import ABC
from collections.abc import Mapping
from dataclasses import dataclass, fields
from fractions import Fraction
from types import MappingProxyType
from typing import ClassVar


@dataclass(frozen=True, slots=True)
class AbstractLaw(ABC):
    """A control law; its fields are its gains, exact single-precision numbers."""

    # As certificates and exports call it, and the unit of every gain.
    name: ClassVar[str]
    units: ClassVar[Mapping[str, str]]

    @property
    def gains(self) -> Mapping[str, Fraction]:
        """The gains by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}


@dataclass(frozen=True, slots=True)
class ProportionalDerivative(AbstractLaw):
    """Motion control ``delta = Kp e + Kd e'`` (thesis 4.3), e in rad, delta in rpm.

    Parameters
    ----------
    Kp : Fraction
        In rpm/rad.
    Kd : Fraction
        In rpm s/rad.
    """

    name: ClassVar[str] = "motion"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({"Kp": "rpm/rad", "Kd": "rpm*s/rad"})

    Kp: Fraction
    Kd: Fraction

    @property
    def zero(self) -> Fraction:
        """The z of ``Kd (s + z)``, in 1/s."""
        return self.Kp / self.Kd


@dataclass(frozen=True, slots=True)
class Admittance(AbstractLaw):
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

    Mt: Fraction
    Bt: Fraction


@dataclass(frozen=True, slots=True)
class ProportionalForce(AbstractLaw):
    """Position correction ``Kp (Fd - F)`` of the force mode (thesis 6.32).

    Parameters
    ----------
    Kp : Fraction
        In rad/(N m).
    """

    name: ClassVar[str] = "force"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({"Kp": "rad/(N*m)"})

    Kp: Fraction


@dataclass(frozen=True, slots=True)
class PositionControl(AbstractLaw):
    """The position mode: the motion loop follows its command, whatever the force."""

    name: ClassVar[str] = "position"
    units: ClassVar[Mapping[str, str]] = MappingProxyType({})


Law = Admittance | ProportionalForce | PositionControl
