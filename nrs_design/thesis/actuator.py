"""Chapter 4.1: the identified actuator and its data sheet."""

from __future__ import annotations

from nrs_design.models.actuator import armature_resistance, speed_torque_gradient, voltage_gain
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import ReproducedValue, Tolerance, misprint, reproduced


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute the actuator's constants from the frequency response and table 4.1."""
    resistance = armature_resistance(thesis.ACTUATOR, thesis.MOTOR)
    return (
        reproduced(
            "time constant tau_m", "4.1", "0.0351", 1 / thesis.BREAK_FREQUENCY, "s", Tolerance(1e-3)
        ),
        reproduced(
            "gain K_m*",
            "4.1",
            "4.8417e-4",
            10 ** (thesis.GAIN_IN_DECIBEL / 20),
            "(rad/s)/rpm",
            Tolerance(1e-4),
        ),
        reproduced(
            "inertia I_r at the motor shaft",
            "4.1",
            "14.81e-7",
            thesis.MOTOR_INERTIA + thesis.GEARHEAD_INERTIA,
            "kg m^2",
            Tolerance(1e-6),
        ),
        misprint(
            "motor gain K_m",
            "4.1",
            "from K_m* = 30 K_m/(N pi K_B)",
            voltage_gain(thesis.ACTUATOR, thesis.MOTOR),
            "rad/(s V)",
            Tolerance(1e-3),
            right="72.77",
            note="The factor below 4.8 is upside down: K_m* = pi K_B K_m/(30 N).",
            errata=("4.8",),
        ),
        misprint(
            "armature resistance R",
            "4.1",
            "3.7754",
            resistance,
            "ohm",
            Tolerance(1e-4),
            right="3.7454",
            note="tau_m/K_m = I_r R/K_T with the printed tau_m gives 3.7454; one digit differs.",
            errata=("R",),
        ),
        misprint(
            "speed/torque gradient",
            "4.10",
            "2.7261e5",
            speed_torque_gradient(resistance, thesis.MOTOR),
            "rpm/(N m)",
            Tolerance(1e-3),
            right="2.7044e5",
            note="It inherits the wrong digit of R.",
            errata=("R",),
        ),
    )
