"""The closed motion loop: velocity command to velocity of one axis."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from nrs_design.models.actuator import Actuator


@dataclass(frozen=True, slots=True)
class MotionLoop:
    """An exact strictly proper transfer function G(s).

    Parameters
    ----------
    numerator, denominator : tuple of Fraction
        Coefficients, highest power first.
    given : bool
        Stated by the spec, instead of following from actuator and motion gains.
    """

    numerator: tuple[Fraction, ...]
    denominator: tuple[Fraction, ...]
    given: bool = False


def close_motion_loop(actuator: Actuator, Kp: Fraction, Kd: Fraction) -> MotionLoop:
    """Close the PD loop around the actuator (thesis 4.28, 6.1).

    Parameters
    ----------
    actuator : Actuator
        Gain in (rad/s)/rpm and time constant in s.
    Kp, Kd : Fraction
        PD gains in rpm/rad and rpm s/rad.
    """
    damping, stiffness = Kd * actuator.gain, Kp * actuator.gain
    return MotionLoop((damping, stiffness), (actuator.time_constant, 1 + damping, stiffness))
