"""PD design by root locus (thesis 4.2-4.3) and the response of the closed motion loop."""

import cmath
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.design.root_locus import (
    design_pd,
    dominant_pair,
    motion_loop_response,
    step_overshoot,
)
from nrs_design.design.transfer import TransferFunction, frequency_response, poles
from nrs_design.errors import DesignError
from nrs_design.models.actuator import Actuator
from nrs_design.models.motion_loop import close_motion_loop

# Thesis 4.25 and 4.14: the actuator, zeta = 0.707 and 4/(zeta wn) = 4 tau.
KM, TAU = 4.8417e-4, 0.0351
ZETA, SETTLING = 0.707, 4 * 0.0351


def second_order_overshoot(zeta, wn, zero):
    """Textbook: peak of wn^2/z (s + z)/(s^2 + 2 zeta wn s + wn^2), from its impulse response."""
    sigma, wd = zeta * wn, wn * math.sqrt(1 - zeta**2)
    peak = (math.pi - math.atan2(wd, zero - sigma)) / wd
    decay = math.exp(-sigma * peak)
    lag = (sigma - wn**2 / zero) / wd
    return -decay * (math.cos(wd * peak) + lag * math.sin(wd * peak))


def test_published_pd_controller():
    design = design_pd(KM, TAU, ZETA, SETTLING)
    assert design.natural_frequency == pytest.approx(40.2971, rel=1e-4)  # thesis 4.14
    assert design.wanted_poles[0] == pytest.approx(-28.4900 + 28.49861j, rel=1e-4)  # 4.27b
    assert design.wanted_poles[1] == design.wanted_poles[0].conjugate()
    assert math.degrees(design.zero_angle) == pytest.approx(44.9914, abs=1e-3)  # 4.28
    assert design.zero == pytest.approx(56.9706, rel=5e-4)  # 4.29
    assert design.derivative_gain == pytest.approx(2065.4, rel=1e-4)  # the thesis rounds to 2060


def closed_loop(gain, time_constant, derivative_gain, zero):
    actuator, Kd = Actuator(Fraction(gain), Fraction(time_constant)), Fraction(derivative_gain)
    loop = close_motion_loop(actuator, Kd * Fraction(zero), Kd)
    return TransferFunction(tuple(map(float, loop.numerator)), tuple(map(float, loop.denominator)))


def test_published_motion_loop_at_the_rounded_gain():
    G = closed_loop(KM, TAU, 2060, 56.9706)
    assert G.numerator == pytest.approx((0.9974, 56.822), rel=1e-4)  # thesis 6.1, exact
    assert G.denominator == pytest.approx((0.0351, 1.9974, 56.822), rel=1e-4)
    assert poles(G)[0] == pytest.approx(-28.453 + 28.448j, rel=1e-4)
    response = motion_loop_response(G)
    assert response.damping_ratio == pytest.approx(0.7072, abs=1e-4)
    assert response.natural_frequency == pytest.approx(40.235, abs=1e-3)
    assert 100 * response.overshoot == pytest.approx(6.8, abs=0.2)
    # The second-order formula without the zero misses it.
    assert math.exp(-math.pi * ZETA / math.sqrt(1 - ZETA**2)) == pytest.approx(0.043, abs=1e-3)
    assert abs(frequency_response(G, response.bandwidth)) == pytest.approx(math.sqrt(0.5))


actuators = {"gain": st.floats(1e-5, 10), "time_constant": st.floats(1e-3, 1)}


@given(**actuators, damping_ratio=st.floats(0.1, 0.95), ratio=st.floats(0.2, 7.9))
def test_angle_and_magnitude_condition_hold(gain, time_constant, damping_ratio, ratio):
    design = design_pd(gain, time_constant, damping_ratio, ratio * time_constant)
    pole = design.wanted_poles[0]
    controller = design.derivative_gain * (pole + design.zero)
    loop = controller * gain / (pole * (time_constant * pole + 1))
    assert loop == pytest.approx(-1, abs=1e-9)
    assert cmath.phase(pole + design.zero) == pytest.approx(design.zero_angle)
    G = closed_loop(gain, time_constant, design.derivative_gain, design.zero)
    assert poles(G)[0] == pytest.approx(pole, rel=1e-5)


@given(zeta=st.floats(0.05, 0.95), wn=st.floats(0.1, 1e4), ratio=st.floats(0.2, 50))
def test_overshoot_of_a_second_order_loop_with_a_zero(zeta, wn, ratio):
    zero = ratio * wn
    tf = TransferFunction((wn**2 / zero, wn**2), (1.0, 2 * zeta * wn, wn**2))
    assert step_overshoot(tf) == pytest.approx(second_order_overshoot(zeta, wn, zero), rel=1e-7)


@pytest.mark.parametrize(
    ("numerator", "denominator", "overshoot"),
    [
        ((1.0,), (1.0, 3.0, 3.0, 1.0), 0.0),
        # (4 s + 1)/(s + 1)^2: y = 1 + (3 t - 1) exp(-t), highest at t = 4/3.
        ((4.0, 1.0), (1.0, 2.0, 1.0), 3 * math.exp(-4 / 3)),
    ],
)
def test_overshoot_by_hand(numerator, denominator, overshoot):
    found = step_overshoot(TransferFunction(numerator, denominator))
    assert found == pytest.approx(overshoot, rel=1e-9)


def test_overshoot_of_a_negative_gain_is_measured_towards_its_final_value():
    positive = TransferFunction((9.0,), (1.0, 1.8, 9.0))
    negative = TransferFunction((-18.0,), (1.0, 1.8, 9.0))
    assert step_overshoot(negative) == pytest.approx(step_overshoot(positive))


def test_dominant_pair_is_the_rightmost_complex_one():
    zeta, wn = dominant_pair(np.array([-100, -3 + 4j, -3 - 4j, -1]))
    assert (zeta, wn) == (pytest.approx(0.6), pytest.approx(5))
    zeta, wn = dominant_pair(np.array([-100.0, -8.0, -2.0]))
    assert (zeta, wn) == (pytest.approx(1.25), pytest.approx(4))


@pytest.mark.parametrize("settling", [8 * TAU, 1.0])
def test_design_refuses_a_settling_time_that_no_positive_gain_reaches(settling):
    with pytest.raises(DesignError, match="no positive gain") as caught:
        design_pd(KM, TAU, ZETA, settling * (1 + 1e-9))
    assert "0.2808 s" in caught.value.remedy


def test_a_lag_of_first_order_is_no_faster_than_its_pole_and_does_not_overshoot():
    found = motion_loop_response(TransferFunction((1.0,), (0.03, 1.0)))
    assert found.poles == (pytest.approx(-1 / 0.03),)
    assert (found.damping_ratio, found.overshoot) == (pytest.approx(1), 0)
    assert found.natural_frequency == found.bandwidth == pytest.approx(1 / 0.03)


def test_a_loop_without_an_overshoot_is_refused():
    with pytest.raises(DesignError, match="unstable"):
        step_overshoot(TransferFunction((1.0,), (1.0, -1.0)))
    with pytest.raises(DesignError, match="static gain"):
        step_overshoot(TransferFunction((1.0, 0.0), (1.0, 1.0)))
