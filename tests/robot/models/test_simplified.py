from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from nrs_design.robot.models.dynamics import gravity_torque, mass_matrix
from nrs_design.robot.models.kinematics import jacobian, orientation, orientation_jacobian
from nrs_design.robot.models.simplified import simplified_dynamics

from .strategies import poses, tilts


def only_platform(robot):
    left, right, middle = robot.without_links().legs
    rotor = replace(middle, axis_inertia=robot.legs[2].axis_inertia)
    return replace(robot, legs=(left, right, rotor))


@given(pose=poses, tilt=tilts)
def test_it_is_the_full_model_without_links(robot, pose, tilt):
    robot = robot.tilted(tilt)
    model, bare = simplified_dynamics(robot, pose), only_platform(robot)
    assert pytest.approx(mass_matrix(bare, pose), abs=1e-15) == model.Ms
    assert pytest.approx(gravity_torque(bare, pose), abs=1e-13) == model.Gs


@given(pose=poses)
def test_as_the_thesis_writes_it(robot, pose):
    # Thesis 3.31 to 3.35, with the angular velocity of 3.33 as printed.
    x, y, d = orientation(pose)
    Rx = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    Ry = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    R = Rx @ Ry
    J = orientation_jacobian(pose) @ jacobian(robot, pose)
    L = np.array([0.0367, 0.0, d + 0.010])
    linear = np.column_stack([np.cross((1, 0, 0), R @ L), np.cross(R[:, 1], R @ L), R[:, 2]]) @ J
    angular = np.diag([1.0, 1.0, 0.0]) @ J
    rod = 0.7972 * 0.25**2 / 12
    inertia = R @ np.diag([rod, rod, 0]) @ R.T + np.diag([14.81e-7, 0, 0])
    Ms = 0.7972 * linear.T @ linear + angular.T @ inertia @ angular
    assert simplified_dynamics(robot, pose, printed=True).Ms == pytest.approx(Ms, abs=1e-14)
