from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from nrs_design.robot.models.geometry import PoseError
from nrs_design.robot.models.kinematics import inverse_kinematics, joint_motion
from nrs_design.robot.models.workspace import (
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


def test_peaks_are_reached_and_not_exceeded(robot):
    grid = workspace_grid(robot, 5, 3)
    peaks = joint_peaks(robot, grid)
    poses = reachable_poses(robot, grid)
    limits = robot.task_limits
    v = [limits.angular_velocity] * 2 + [limits.linear_velocity]
    a = [limits.angular_acceleration] * 2 + [limits.linear_acceleration]
    signs = np.array(list(product((1, -1), repeat=6))).reshape(-1, 2, 3)
    motions = [joint_motion(robot, poses, s[0] * v, s[1] * a) for s in signs]
    velocity, acceleration = (
        np.max([np.abs(getattr(one, name)).max(axis=0) for one in motions], axis=0)
        for name in ("velocity", "acceleration")
    )
    assert velocity == pytest.approx(peaks[0])
    assert acceleration == pytest.approx(peaks[1])


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
