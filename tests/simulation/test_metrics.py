"""Metrics by hand, and numbers of the thesis and of the literature."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.simulation import metrics

T = np.array([0.0, 1.0, 1.5, 4.0])
LINE = np.array([0.0, 2.0, 3.0, 8.0])


def test_integrals_of_a_straight_line_are_exact():
    assert metrics.integral(T, LINE) == pytest.approx(16)
    assert metrics.mean(T, LINE) == pytest.approx(4)
    assert metrics.rms(T, LINE) == pytest.approx(8 / math.sqrt(3))


@given(st.floats(-1, 9))
def test_time_above_is_interpolated(limit):
    assert metrics.time_above(T, LINE, limit) == pytest.approx(4 - min(max(limit / 2, 0), 4))


def test_a_run_without_length():
    one = np.array([3.0])
    assert metrics.mean(one, one) == metrics.rms(one, one) == 3
    assert metrics.time_above(one, one, 0.0) == 0


def test_displayed_impedance_is_torque_over_command():
    command = np.array([0.1, 0.1, 0.005, -0.1, 0.1])
    torque = np.array([0.2, 0.0, 0.2, -0.3, 0.2])
    quotient, taken = metrics.displayed_impedance(command, torque)
    assert taken.tolist() == [True, False, False, True, True]
    assert quotient == pytest.approx([2, 0, 0, 3, 2])
    t = np.arange(5.0)
    assert metrics.impedance_rmse(t, command, torque, 2.0) == pytest.approx(math.sqrt(0.5))
    assert metrics.impedance_rmse(t, command, 0 * torque, 2.0) is None


def test_withdrawals_are_timed_to_the_loss_of_contact():
    t = np.arange(8.0)
    command = np.array([1, -1, -1, -1, 1, -1, 1, -1])
    torque = np.array([1, 1, 1, 0, 1, 1, 1, 1])
    assert metrics.withdrawal_times(t, command, torque) == (2.0,)
    assert metrics.withdrawal_times(t, -command, -torque) == (2.0,)


def test_effort():
    found = metrics.effort(T, -LINE, np.ones(4))
    assert (found.total, found.energy) == pytest.approx((16, 16))
    assert found.rms == pytest.approx(8 / math.sqrt(3))


def test_overshoot_and_steady_state():
    t = np.linspace(0, 10, 1001)
    y = -0.3 * (1 - np.exp(-t) * np.cos(3 * t))
    assert metrics.overshoot(y, -0.3) == pytest.approx(np.exp(-np.pi / 3), rel=0.1)
    assert metrics.overshoot(0 * y, -0.3) == 0
    assert metrics.steady_state_error(t, 0.9 * y, -0.3) == pytest.approx(0.1, abs=1e-3)
