"""Thesis 4.1: the identified motor, and the constants that follow from its data sheet."""

from fractions import Fraction

import pytest

from nrs_design.models.actuator import (
    Actuator,
    MotorConstants,
    armature_resistance,
    speed_torque_gradient,
    voltage_gain,
)

ACTUATOR = Actuator(Fraction("4.8417e-4"), Fraction("0.0351"))
# Thesis table 4.1 (K_T = K_B = 0.0115, 14.5 + 0.31 g cm^2), and a reduction of 905/5.
MOTOR = MotorConstants(
    torque_constant=0.0115, back_emf_constant=0.0115, inertia=14.81e-7, reduction=181.0
)


def test_voltage_gain():
    """K_m* = pi K_B K_m / (30 N), the inverse of what is printed after 4.8."""
    assert voltage_gain(ACTUATOR, MOTOR) == pytest.approx(72.77, rel=1e-3)


def test_resistance():
    """Thesis 4.6; the print says 3.7754 ohm, its own numbers give 3.7454."""
    assert armature_resistance(ACTUATOR, MOTOR) == pytest.approx(3.7454, rel=1e-4)


@pytest.mark.parametrize(("resistance", "gradient"), [(3.7754, 2.7261e5), (3.7454, 2.7044e5)])
def test_gradient(resistance, gradient):
    """Thesis 4.10, with the printed resistance and with the right one."""
    assert speed_torque_gradient(resistance, MOTOR) == pytest.approx(gradient, rel=1e-4)
