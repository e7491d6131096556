"""The motor with friction, against an integrator and by hand."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.simulation.motor import Motor

KM, TAU = 4.8417e-4, 0.0351
SPEED, COMMAND, TIME = st.floats(-1, 1), st.floats(-3000, 3000), st.floats(1e-4, 0.1)
FRICTION = st.sampled_from([0.0, 55.3])


@given(SPEED, COMMAND, TIME)
def test_without_friction_it_is_a_lag_by_hand(omega, command, time):
    final, gone = KM * command, 1 - math.exp(-time / TAU)
    wanted = final * time + TAU * (omega - final) * gone, omega + (final - omega) * gone
    assert Motor(KM, TAU).after(0.0, omega, command, time) == pytest.approx(wanted, abs=1e-12)


@given(SPEED, COMMAND, FRICTION, TIME, TIME)
def test_a_stop_on_the_way_changes_nothing(omega, command, friction, first, second):
    motor = Motor(KM, TAU, friction)
    there = motor.after(*motor.after(0.0, omega, command, first), command, second)
    assert there == pytest.approx(motor.after(0.0, omega, command, first + second), abs=1e-11)


@given(SPEED, COMMAND, FRICTION)
def test_it_begins_with_the_rate_of_its_equation(omega, command, friction):
    motor, h = Motor(KM, TAU, friction), 1e-7
    _, after = motor.after(0.0, omega, command, h)
    sign = math.copysign(1.0, omega if omega else command)
    rate = (KM * (command - sign * friction) - omega) / TAU
    if omega == 0 and abs(command) <= friction:
        rate = 0.0
    elif abs(omega) < abs(2 * rate * h):
        return  # It comes to rest within that time, or passes through it.
    assert (after - omega) / h == pytest.approx(rate, rel=1e-4, abs=1e-6)


def test_friction_holds_what_is_too_weak():
    motor = Motor(4.8417e-4, 0.0351, 55.3)
    assert motor.after(0.1, 0.0, 55.0, 1.0) == (0.1, 0.0)
    theta, omega = motor.after(0.0, 0.02, 10.0, 10.0)
    assert omega == 0
    # It glides to rest: tau ln(1 + omega/drag) at drag = Km (f - u).
    drag = 4.8417e-4 * 45.3
    rest = 0.0351 * (0.02 - drag * math.log1p(0.02 / drag))
    assert theta == pytest.approx(rest, rel=1e-9)
