"""The motor with friction, against an integrator and by hand."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from nrs_design.models.drive import lagging_drive, position_drive, velocity_drive
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.simulation.motor import DrivenJoint, Motor

KM, TAU = 4.8417e-4, 0.0351
SPEED, COMMAND, TIME = st.floats(-1, 1), st.floats(-3000, 3000), st.floats(1e-4, 0.1)
FRICTION = st.sampled_from([0.0, 55.3])


@given(SPEED, COMMAND, TIME)
def test_without_friction_it_is_a_lag_by_hand(omega, command, time):
    final, gone = KM * command, 1 - math.exp(-time / TAU)
    wanted = final * time + TAU * (omega - final) * gone, omega + (final - omega) * gone
    assert Motor(KM, TAU).advance(0.0, omega, command, time) == pytest.approx(wanted, abs=1e-12)


@given(SPEED, COMMAND, FRICTION, TIME, TIME)
def test_a_stop_on_the_way_changes_nothing(omega, command, friction, first, second):
    motor = Motor(KM, TAU, friction)
    there = motor.advance(*motor.advance(0.0, omega, command, first), command, second)
    assert there == pytest.approx(motor.advance(0.0, omega, command, first + second), abs=1e-11)


@given(SPEED, COMMAND, FRICTION)
def test_it_begins_with_the_rate_of_its_equation(omega, command, friction):
    motor, h = Motor(KM, TAU, friction), 1e-7
    _, after = motor.advance(0.0, omega, command, h)
    sign = math.copysign(1.0, omega if omega else command)
    rate = (KM * (command - sign * friction) - omega) / TAU
    if omega == 0 and abs(command) <= friction:
        rate = 0.0
    elif abs(omega) < abs(2 * rate * h):
        return  # It comes to rest within that time, or passes through it.
    assert (after - omega) / h == pytest.approx(rate, rel=1e-4, abs=1e-6)


def test_friction_holds_what_is_too_weak():
    motor = Motor(4.8417e-4, 0.0351, 55.3)
    assert motor.advance(0.1, 0.0, 55.0, 1.0) == (0.1, 0.0)
    theta, omega = motor.advance(0.0, 0.02, 10.0, 10.0)
    assert omega == 0
    # It glides to rest: tau ln(1 + omega/drag) at drag = Km (f - u).
    drag = 4.8417e-4 * 45.3
    rest = 0.0351 * (0.02 - drag * math.log1p(0.02 / drag))
    assert theta == pytest.approx(rest, rel=1e-9)


F = Fraction
THIRD = MotionLoop((F(5), F(300)), (F(1), F(20), F(130), F(300)))
DRIVES = {
    "velocity": velocity_drive(THIRD),
    "position": position_drive(THIRD),
    "jumping": position_drive(MotionLoop((F(28), F(1619)), (F(1), F(57), F(1619)))),
    "lag": lagging_drive(Interval(F(3, 100), F(1, 50), F(1, 25))),
}


@pytest.mark.parametrize("name", sorted(DRIVES))
def test_pieces_are_the_integral(name):
    """Against an integrator, a command after the other."""
    drive = DRIVES[name]
    joint = DrivenJoint.create(drive)
    n = drive.order
    theta, omega = 0.3, 0.0
    z = np.zeros(n)
    z[-1] = theta
    for command, time in ((0.5, 0.013), (-0.2, 0.004), (0.1, 0.2)):
        theta, omega = joint.advance(theta, omega, command, time)

        def rates(t, z, u=command):
            return joint.generator[:n, :n] @ z + joint.generator[:n, n] * u

        z = solve_ivp(rates, (0, time), z, rtol=1e-10, atol=1e-12).y[:, -1]
        speed = z[0] if joint.speed is None else joint.speed @ [*z, command]
        assert (theta, omega) == pytest.approx((z[-1], speed), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ["position", "jumping", "lag"])
def test_a_robot_that_follows_positions_rests_where_it_is_sent(name):
    joint = DrivenJoint.create(DRIVES[name])
    assert joint.advance(1.7, 0.0, 1.7, 0.5) == pytest.approx((1.7, 0.0), abs=1e-9)
    assert joint.advance(1.7, 0.0, 0.4, 30.0) == pytest.approx((0.4, 0.0), abs=1e-9)
