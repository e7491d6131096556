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


def motor(**changes):
    # K_m = 72.77 rad/(s V) asks for K_B = K_T = 1/K_m, the ideal machine; N = 905/5 = 181.
    given = {
        "torque_constant": 0.0137,
        "back_emf_constant": 0.0137,
        "inertia": 14.81e-7,
        "reduction": 181.0,
    }
    return MotorConstants(**given | changes)


def test_voltage_gain_inverts_the_identified_one():
    """K_m* = pi K_B K_m / (30 N) (erratum of 4.8)."""
    from math import pi

    constants = motor()
    gain = voltage_gain(ACTUATOR, constants)
    back = pi * constants.back_emf_constant * gain / (30 * constants.reduction)
    assert back == pytest.approx(4.8417e-4)
    doubled = voltage_gain(ACTUATOR, motor(reduction=362.0))
    assert doubled == pytest.approx(2 * gain)


def test_resistance_satisfies_its_equation():
    """tau_m / K_m = I_r R / K_T (thesis 4.6)."""
    constants = motor()
    R = armature_resistance(ACTUATOR, constants)
    gain = voltage_gain(ACTUATOR, constants)
    assert R * constants.inertia / constants.torque_constant == pytest.approx(0.0351 / gain)


def test_gradient_of_the_data_sheet():
    """Thesis 4.10: with R = 3.7454 ohm the gradient is 2.7044e5 rpm/(N m), printed 2.7261e5."""
    from math import pi, sqrt

    torque_constant = sqrt(30 / pi * 3.7754 / 2.7261e5)
    constants = motor(torque_constant=torque_constant)
    assert speed_torque_gradient(3.7754, constants) == pytest.approx(2.7261e5)
    assert speed_torque_gradient(3.7454, constants) == pytest.approx(2.7044e5, rel=1e-4)
