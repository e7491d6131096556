"""The control laws that run on the robot, one axis each, with the gains that ship.

All gains are exact rationals that are single-precision numbers, so that a proof, a simulation
and an export speak about the same values.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction


@dataclass(frozen=True, slots=True)
class ProportionalDerivative:
    """Motion control ``delta = Kp e + Kd e'`` (thesis 4.3), e in rad, delta in rpm.

    Parameters
    ----------
    Kp : Fraction
        In rpm/rad.
    Kd : Fraction
        In rpm s/rad.
    """

    Kp: Fraction
    Kd: Fraction

    @property
    def zero(self) -> Fraction:
        """The z of ``Kd (s + z)``, in 1/s."""
        return self.Kp / self.Kd


@dataclass(frozen=True, slots=True)
class Admittance:
    """Velocity correction ``vm = F / (Mt s + Bt)`` (thesis 6.8), subtracted from the command.

    Parameters
    ----------
    Mt : Fraction
        Virtual inertia in kg m^2; zero makes the law static.
    Bt : Fraction
        Virtual damping in N m s/rad; positive.
    """

    Mt: Fraction
    Bt: Fraction


@dataclass(frozen=True, slots=True)
class ProportionalForce:
    """Position correction ``Kp (Fd - F)`` of the force mode (thesis 6.32).

    Parameters
    ----------
    Kp : Fraction
        In rad/(N m).
    """

    Kp: Fraction


@dataclass(frozen=True, slots=True)
class PositionControl:
    """The position mode: the motion loop follows its command, whatever the force."""


Law = Admittance | ProportionalForce | PositionControl
