import numpy as np
import pytest

from nrs_design.robot.models import thesis_grid, torque_shares


def test_published_shares(robot):
    # Thesis 3.3 prints 75.5, 11.5 and 13 %.
    means = torque_shares(robot, thesis_grid()).means
    assert means == pytest.approx((0.7551, 0.1145, 0.1303), abs=1e-4)


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
