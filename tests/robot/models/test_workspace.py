from dataclasses import replace

import numpy as np
import pytest

from nrs_design.errors import PoseError
from nrs_design.robot.models import (
    inverse_kinematics,
    joint_motion,
    joint_peaks,
    reachable_poses,
    survey_workspace,
    thesis_grid,
    workspace_grid,
)


def test_grids(robot):
    assert thesis_grid().shape == (29 * 39 * 3, 3)
    grid = workspace_grid(robot, 5, 3)
    assert grid.shape == (5, 5, 3, 3)
    assert grid[0, 0, 0] == pytest.approx([*np.radians([-15, -20]), 0.15])
    assert grid[-1, -1, -1] == pytest.approx([*np.radians([15, 20]), 0.25])


def test_corners(robot):
    survey = survey_workspace(robot)
    deepest = {(round(phi, 3), round(psi, 3)): d for phi, psi, d in survey.deepest}
    assert deepest[0.262, -0.349] == deepest[-0.262, -0.349] == pytest.approx(0.2445, abs=1e-4)
    assert deepest[0.262, 0.349] == pytest.approx(0.25)
    assert 0.999 < survey.reachable < 1


def test_peaks_are_reached_and_not_exceeded(robot):
    grid = workspace_grid(robot, 5, 3)
    peaks = joint_peaks(robot, grid)
    poses = reachable_poses(robot, grid)
    rng = np.random.default_rng(2)
    limits = robot.task_limits
    v = [limits.angular_velocity] * 2 + [limits.linear_velocity]
    a = [limits.angular_acceleration] * 2 + [limits.linear_acceleration]
    for _ in range(200):
        signs = rng.choice([-1, 1], (2, 3))
        motion = joint_motion(robot, poses, signs[0] * v, signs[1] * a)
        assert np.all(np.abs(motion.velocity) <= peaks.velocity + 1e-12)
        assert np.all(np.abs(motion.acceleration) <= peaks.acceleration + 1e-12)
    corner = joint_motion(robot, peaks.velocity_pose[2], [v[0], v[1], v[2]], np.zeros(3))
    other = joint_motion(robot, peaks.velocity_pose[2], [v[0], -v[1], v[2]], np.zeros(3))
    fastest = max(abs(corner.velocity[2]), abs(other.velocity[2]))
    assert fastest == pytest.approx(peaks.velocity[2])


def test_unreachable_poses_are_left_out(robot):
    poses = [[0, 0, 0.2], [0, 0, 0.9]]
    assert reachable_poses(robot, poses).tolist() == [[0, 0, 0.2]]
    with pytest.raises(PoseError, match="overstretched"):
        reachable_poses(robot, poses[1:])


def test_a_robot_that_cannot_reach_its_middle(robot):
    short = replace(robot, legs=tuple(replace(leg, l1=0.05, l2=0.05) for leg in robot.legs))
    with pytest.raises(PoseError, match="overstretched"):
        survey_workspace(short)
    assert inverse_kinematics(robot, robot.home)[2] > 0
