"""A robot with a drive of its own in a simulation: pieces of a command, and rest."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from nrs_design.models.drive import lagging_drive, position_drive, velocity_drive
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.simulation.motor import DrivenJoint

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
    joint = DrivenJoint.of(drive)
    n = drive.order
    theta, omega = 0.3, 0.0
    z = np.zeros(n)
    z[-1] = theta
    for command, time in ((0.5, 0.013), (-0.2, 0.004), (0.1, 0.2)):
        theta, omega = joint.after(theta, omega, command, time)

        def rates(t, z, u=command):
            return joint.generator[:n, :n] @ z + joint.generator[:n, n] * u

        z = solve_ivp(rates, (0, time), z, rtol=1e-10, atol=1e-12).y[:, -1]
        speed = z[0] if joint.speed is None else joint.speed @ [*z, command]
        assert (theta, omega) == pytest.approx((z[-1], speed), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("name", ["position", "jumping", "lag"])
def test_a_robot_that_follows_positions_rests_where_it_is_sent(name):
    joint = DrivenJoint.of(DRIVES[name])
    assert joint.after(1.7, 0.0, 1.7, 0.5) == pytest.approx((1.7, 0.0), abs=1e-9)
    assert joint.after(1.7, 0.0, 0.4, 30.0) == pytest.approx((0.4, 0.0), abs=1e-9)
