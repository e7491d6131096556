"""Velocity-controlled DC motor with gearhead (thesis 4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import pi


@dataclass(frozen=True, slots=True)
class Actuator:
    """Identified actuator ``theta_m(s)/delta(s) = gain / (s (time_constant s + 1))``.

    Parameters
    ----------
    gain : Fraction
        In (rad/s)/rpm: gearhead speed over the speed command of the motor driver.
    time_constant : Fraction
        In s.
    """

    gain: Fraction
    time_constant: Fraction


@dataclass(frozen=True, slots=True)
class MotorConstants:
    """Data-sheet constants of motor and gearhead (thesis table 4.1).

    Parameters
    ----------
    torque_constant : float
        K_T in N m/A.
    back_emf_constant : float
        K_B in V s/rad.
    inertia : float
        Motor and gearhead, at the motor shaft, in kg m^2.
    reduction : float
        Gearhead ratio N.
    """

    torque_constant: float
    back_emf_constant: float
    inertia: float
    reduction: float


def voltage_gain(actuator: Actuator, motor: MotorConstants) -> float:
    """Return K_m, motor speed over voltage in rad/(s V).

    ``K_m* = pi K_B K_m / (30 N)``; the thesis prints the inverse factor after 4.8.
    """
    return float(actuator.gain) * 30 * motor.reduction / (pi * motor.back_emf_constant)


def armature_resistance(actuator: Actuator, motor: MotorConstants) -> float:
    """Return R in ohm from ``tau_m / K_m = I_r R / K_T`` (thesis 4.6)."""
    gain = voltage_gain(actuator, motor)
    return float(actuator.time_constant) * motor.torque_constant / (motor.inertia * gain)


def speed_torque_gradient(resistance: float, motor: MotorConstants) -> float:
    """Return the speed loss per torque in rpm/(N m), ``30/pi R/K_T^2`` (thesis 4.10)."""
    return 30 / pi * resistance / motor.torque_constant**2
