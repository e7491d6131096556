"""The motor of the robot and its formulas (thesis 4.1)."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from nrs_design.models.actuator import Actuator


@dataclass(frozen=True, slots=True)
class MotorConstants:
    """Data-sheet constants of motor and gearhead (thesis table 4.1)."""

    torque_constant: float  # K_T in N m/A
    back_emf_constant: float  # K_B in V s/rad
    inertia: float  # Motor and gearhead, at the motor shaft, in kg m^2
    reduction: float  # Gearhead ratio N


MOTOR = MotorConstants(0.0115, 0.0115, 14.81e-7, 181.0)


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
