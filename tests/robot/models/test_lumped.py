"""Masses moved between links that share a point: another robot with the same torques."""

import numpy as np

from nrs_design.robot.models import inverse_dynamics, is_reachable
from nrs_design.robot.models.lumped import lumped
from tests.robot.models.crooked import crooked

RNG = np.random.default_rng(12)


def test_torques_stay(robot):
    """Of the thesis robot and of one without any symmetry, gravity and velocities included."""
    for one in (robot, crooked(robot)):
        pose = RNG.uniform((-0.2, -0.3, 0.16), (0.2, 0.3, 0.23), (40, 3))
        pose = pose[is_reachable(one, pose)]
        velocity, acceleration = RNG.normal(0, 1, pose.shape), RNG.normal(0, 5, pose.shape)
        wanted = inverse_dynamics(one, pose, velocity, acceleration)
        found = inverse_dynamics(lumped(one), pose, velocity, acceleration)
        np.testing.assert_allclose(found, wanted, atol=1e-12, rtol=1e-10)


def test_couplers_are_left_without_mass_and_arms_with_theirs_at_the_joint(robot):
    made = lumped(robot)
    for leg in made.legs:
        assert (leg.coupler.mass, *leg.coupler.first) == (0.0, 0.0, 0.0, 0.0)
    assert [leg.arm.first[0] for leg in made.legs[:2]] == [0.0, 0.0]
    np.testing.assert_allclose(made.moving_mass, robot.moving_mass, rtol=1e-14)
