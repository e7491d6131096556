from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given

from nrs_design.robot.models.geometry import PoseError, direction, posture
from nrs_design.robot.models.kinematics import (
    coupler_margin,
    direct_kinematics,
    inverse_jacobian,
    inverse_kinematics,
    jacobian,
    joint_motion,
    orientation,
    orientation_jacobian,
)

from .strategies import poses, rates

TINY = 1e-30


@given(pose=poses)
def test_round_trip(robot, pose):
    there = inverse_kinematics(robot, pose)
    assert direct_kinematics(robot, there) == pytest.approx(pose, abs=1e-13)


@given(pose=poses)
def test_side_angles_are_those_of_the_thesis(robot, pose):
    # Thesis 3.8 and 3.9.
    phi, psi, _ = pose
    down = np.sqrt(1 - np.sin(psi) ** 2 - np.sin(phi) ** 2)
    left = np.arctan((np.sin(phi) - np.sin(psi)) / np.sqrt(2) / down)
    right = np.arctan((np.sin(phi) + np.sin(psi)) / np.sqrt(2) / down)
    assert inverse_kinematics(robot, pose)[:2] == pytest.approx([left, right], abs=1e-14)


@given(pose=poses)
def test_crank_angle_is_that_of_the_corrected_formula(robot, pose):
    # Thesis 3.10 with the arguments of atan2 in the right order.
    _, psi, d = pose
    l0, l1, l2, l3 = 0.2, 0.135, 0.195, 0.2
    c, s = np.cos(np.pi / 2 - psi), np.sin(np.pi / 2 - psi)
    x, y = d * c + l3 * s - l0, d * s - l3 * c
    angle = np.arctan2(y, x) - np.arccos((x**2 + y**2 + l1**2 - l2**2) / (2 * l1 * np.hypot(x, y)))
    assert inverse_kinematics(robot, pose)[2] == pytest.approx(angle, abs=1e-12)


@given(pose=poses)
def test_jacobian_by_complex_steps(robot, pose):
    joints = inverse_kinematics(robot, pose)
    columns = [
        direct_kinematics(robot, joints + TINY * 1j * unit).imag / TINY for unit in np.eye(3)
    ]
    assert jacobian(robot, pose) == pytest.approx(np.stack(columns, axis=-1), abs=1e-12)


@given(pose=poses)
def test_inverse_jacobian(robot, pose):
    product = jacobian(robot, pose) @ inverse_jacobian(robot, pose)
    assert product == pytest.approx(np.eye(3), abs=1e-13)


@given(pose=poses)
def test_orientation_turns_z_into_the_endoscope(pose):
    # Thesis 3.16, corrected.
    x, y, d = orientation(pose)
    turned = (np.sin(y), -np.sin(x) * np.cos(y), np.cos(x) * np.cos(y))
    assert turned == pytest.approx(direction(pose), abs=1e-14)
    assert d == pose[2]


@given(pose=poses)
def test_orientation_jacobian(pose):
    step = 1e-6
    columns = [
        (orientation(pose + step * unit) - orientation(pose - step * unit)) / (2 * step)
        for unit in np.eye(3)
    ]
    assert orientation_jacobian(pose) == pytest.approx(np.stack(columns, -1), abs=1e-8)


@given(pose=poses, velocity=rates, acceleration=rates)
def test_joint_motion_along_a_parabola(robot, pose, velocity, acceleration):
    velocity, acceleration = 0.1 * velocity, 0.1 * acceleration
    motion = joint_motion(robot, pose, velocity, acceleration)
    h = 1e-4
    before, now, after = (
        inverse_kinematics(robot, pose + t * velocity + t * t / 2 * acceleration)
        for t in (-h, 0, h)
    )
    assert motion.position == pytest.approx(now, abs=1e-14)
    assert motion.velocity == pytest.approx((after - before) / (2 * h), abs=1e-6)
    assert motion.acceleration == pytest.approx((after - 2 * now + before) / h**2, abs=1e-5)


def test_batches_have_any_shape(robot):
    grid = np.broadcast_to((0.1, -0.2, 0.2), (2, 3, 3))
    assert inverse_kinematics(robot, grid).shape == (2, 3, 3)
    assert jacobian(robot, grid).shape == (2, 3, 3, 3)
    assert jacobian(robot, grid)[1, 2] == pytest.approx(jacobian(robot, grid[0, 0]), abs=0)


def test_joint_angles_without_a_pose(robot):
    with pytest.raises(PoseError, match=r"middle leg is [0-9.]+ mm too far from the endoscope"):
        direct_kinematics(robot, (0.9, -0.9, -1.6))


def test_elbow_inwards_is_the_mirrored_leg(robot):
    inwards = replace(robot, legs=tuple(replace(leg, elbow_sign=1) for leg in robot.legs))
    joints = inverse_kinematics(inwards, robot.home)
    assert joints[2] > inverse_kinematics(robot, robot.home)[2]


@given(pose=poses)
def test_coupler_margin_is_the_hold_of_the_crank_on_the_depth(robot, pose):
    # Where the coupler is across the endoscope, the crank moves the depth without end.
    margin, middle = coupler_margin(robot, pose), posture(robot, pose).legs[2]
    hold = 0.135 * middle.sin_elbow / margin[2]
    assert jacobian(robot, pose)[2, 2] == pytest.approx(hold, rel=1e-12)
    assert np.all((margin > 0.7) & (margin <= 1))
