"""The element that forgets its deflection, against closed forms and an integrator."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.models.contact.motion import Motion
from nrs_design.models.contact.relaxation import run_first_order
from tests.identification.support import wobble

TAU = 0.3


def test_ramp_then_hold():
    time = np.array([0.0, 0.05, 0.3, 0.5, 1.1, 1.2])
    motion = Motion(time, 2.0 * np.minimum(time, 0.5))
    y = motion.relaxed(TAU).y
    top = 2.0 * TAU * (1 - np.exp(-0.5 / TAU))
    wanted = np.where(
        time <= 0.5, 2.0 * TAU * (1 - np.exp(-time / TAU)), top * np.exp((0.5 - time) / TAU)
    )
    assert y == pytest.approx(wanted, abs=1e-15)


@given(st.floats(-2.0, 2.0))
def test_slope_by_the_logarithm_of_the_time_constant(log_tau):
    motion, h = wobble(2), 1e-5
    above, below = (motion.relaxed(np.exp(log_tau + step)).y for step in (h, -h))
    slope = motion.relaxed(float(np.exp(log_tau))).slope
    assert slope == pytest.approx((above - below) / (2 * h), abs=1e-7)


@given(st.lists(st.tuples(st.floats(0, 1), st.floats(-10, 10)), min_size=1, max_size=30))
def test_a_recursion_equals_the_loop(pairs):
    factors, inputs = np.array(pairs).T
    y = [0.0]
    for factor, value in pairs:
        y.append(factor * y[-1] + value)
    assert np.allclose(run_first_order(factors, inputs), y, rtol=1e-12, atol=1e-12)
