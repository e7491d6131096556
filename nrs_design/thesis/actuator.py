"""Chapter 4.1: the identified actuator and its data sheet."""

from __future__ import annotations

from collections.abc import Iterable

from nrs_design.models.actuator import armature_resistance, speed_torque_gradient, voltage_gain
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Found


def results() -> Iterable[Found]:
    """Recompute the actuator's constants from the frequency response and table 4.1."""
    resistance = armature_resistance(thesis.ACTUATOR, thesis.MOTOR)
    return (
        1 / thesis.BREAK_FREQUENCY,
        10 ** (thesis.GAIN_IN_DECIBEL / 20),
        thesis.MOTOR_INERTIA + thesis.GEARHEAD_INERTIA,
        voltage_gain(thesis.ACTUATOR, thesis.MOTOR),
        resistance,
        speed_torque_gradient(resistance, thesis.MOTOR),
    )
