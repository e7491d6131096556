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
    # Thesis 6.3.2.3, second experiment: 0.53 s and 0.41 s; printed as 21 %.
    assert metrics.gain_in_time(0.53, 0.41) == pytest.approx(0.226, abs=1e-3)


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


def test_safe_speed_is_the_inverse_of_the_criterion():
    """Bicchi and Tonietti 2004, eq. 2, as thesis 2.15; 2.17 with its exponent."""
    factor = metrics.injury_factor(1.0, 4.0, 25_000.0)
    assert factor == pytest.approx(2 * (2 / np.pi) ** 1.5 * 6250**0.75 * 0.2**1.75)
    assert metrics.head_injury(factor, metrics.safe_speed(factor, 100.0)) == pytest.approx(100)
    assert metrics.head_injury(factor, 2.0) / metrics.head_injury(factor, 1.0) == pytest.approx(
        2**2.5
    )
    with pytest.raises(ValueError, match="positive"):
        metrics.injury_factor(1.0, 0.0, 1.0)


def test_head_injury_in_round_numbers():
    """16^0.75 is 8, (1/16)^1.75 is 1/128, 4^2.5 is 32: 2.15 leaves 4 (2/pi)^1.5."""
    factor = metrics.injury_factor(1.0, 15.0, 240.0)
    assert metrics.head_injury(factor, 4.0) == pytest.approx(4 * (2 / math.pi) ** 1.5)
    assert metrics.safe_speed(factor, 4 * (2 / math.pi) ** 1.5) == pytest.approx(4)


def test_peak_and_mean_speed():
    assert metrics.peak(-LINE) == 8
    # There and back: |v| of a straight line to 2 rad/s and of one to -2.
    t, v = np.array([0.0, 1.0, 1.0, 2.0]), np.array([0.0, 2.0, 0.0, -2.0])
    assert metrics.mean_speed(t, v) == pytest.approx(1)


def test_attention_free_time_and_fan_out():
    """Thesis 2.10 to 2.13: a robot that needs 1 s in 4 leaves 3/4 free, and three others."""
    demand = metrics.attention_demand(1.0, 3.0)
    assert (demand, metrics.free_time(demand), metrics.fan_out(demand)) == (0.25, 0.75, 4.0)
    assert metrics.fan_out(demand, 0.5) == 2.0
    assert metrics.attention_demand(2.0, 0.0) == metrics.fan_out(1.0) == 1.0
    assert metrics.fan_out(0.0) == math.inf


@pytest.mark.parametrize("times", [(0.0, 0.0), (-1.0, 2.0), (1.0, math.inf), (math.nan, 1.0)])
def test_times_of_attention_are_checked(times):
    with pytest.raises(ValueError, match="not both zero"):
        metrics.attention_demand(*times)


@pytest.mark.parametrize("share", [-0.1, 1.1, math.nan])
def test_shares_are_checked(share):
    with pytest.raises(ValueError, match="attention demand is a share"):
        metrics.free_time(share)
    with pytest.raises(ValueError, match="human reliability is a share"):
        metrics.fan_out(0.5, share)
