import numpy as np
import pytest

from nrs_design.robot.models.shares import torque_shares


def test_shares_add_up(robot):
    shares = torque_shares(robot, [[0, 0, 0.2], [0.1, -0.2, 0.2]])
    assert shares.gravity + shares.coriolis + shares.inertia == pytest.approx(np.ones((2, 3)))
    assert min(part.min() for part in (shares.gravity, shares.coriolis, shares.inertia)) >= 0


def test_at_rest_all_is_gravity(robot):
    shares = torque_shares(robot, robot.home, (0, 0, 0), (0, 0, 0))
    assert shares.means == (1, 0, 0)


def test_weightless_and_slow_all_is_inertia(robot):
    from dataclasses import replace

    shares = torque_shares(replace(robot, gravity=0.0), robot.home, (0, 0, 0), (1, 1, 1))
    assert shares.means == (0, 0, 1)
