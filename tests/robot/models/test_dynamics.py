"""Properties of the full dynamics; its values are in test_pinocchio."""

import numpy as np
import pytest
from hypothesis import given

from nrs_design.robot.models.dynamics import (
    coriolis_matrix,
    gravity_torque,
    inverse_dynamics,
    mass_and_bias,
    mass_matrix,
    potential_energy,
)
from nrs_design.robot.models.kinematics import jacobian

from .strategies import poses, rates, tilts


@given(pose=poses)
def test_mass_matrix_is_symmetric_and_positive_definite(robot, pose):
    M = mass_matrix(robot, pose)
    assert pytest.approx(M.T, abs=1e-15) == M
    assert np.linalg.eigvalsh(M).min() > 1e-3


@given(pose=poses, velocity=rates, acceleration=rates, tilt=tilts)
def test_torque_is_the_sum_of_its_parts(robot, pose, velocity, acceleration, tilt):
    robot = robot.tilted(tilt)
    M, C = mass_matrix(robot, pose), coriolis_matrix(robot, pose, velocity)
    G = gravity_torque(robot, pose)
    torque = inverse_dynamics(robot, pose, velocity, acceleration)
    assert M @ acceleration + C @ velocity + G == pytest.approx(torque, abs=1e-12)
    again, bias = mass_and_bias(robot, pose, velocity)
    assert again == pytest.approx(M, abs=1e-15)
    assert bias == pytest.approx(C @ velocity + G, abs=1e-12)


@given(pose=poses, velocity=rates)
def test_rate_of_mass_less_twice_coriolis_is_skew(robot, pose, velocity):
    along = jacobian(robot, pose) @ velocity
    h = 1e-5
    rate = (mass_matrix(robot, pose + h * along) - mass_matrix(robot, pose - h * along)) / (2 * h)
    skew = rate - 2 * coriolis_matrix(robot, pose, velocity)
    assert skew == pytest.approx(-skew.T, abs=1e-6)


@given(pose=poses, tilt=tilts)
def test_gravity_is_the_slope_of_the_potential(robot, pose, tilt):
    robot, h = robot.tilted(tilt), 1e-6
    J = jacobian(robot, pose)
    slopes = [
        (potential_energy(robot, pose + h * column) - potential_energy(robot, pose - h * column))
        / (2 * h)
        for column in J.T
    ]
    assert gravity_torque(robot, pose) == pytest.approx(slopes, abs=1e-7)


def test_batch_is_pose_by_pose(robot):
    rng = np.random.default_rng(3)
    pose = rng.uniform((-0.24, -0.33, 0.155), (0.24, 0.33, 0.24), (10_000, 3))
    velocity, acceleration = rng.normal(0, 2, (2, 10_000, 3))
    batch = inverse_dynamics(robot, pose, velocity, acceleration)
    for i in range(0, 10_000, 997):
        alone = inverse_dynamics(robot, pose[i], velocity[i], acceleration[i])
        assert batch[i] == pytest.approx(alone, abs=1e-12)
    C = coriolis_matrix(robot, pose[:5], velocity[:5])
    assert C[4] == pytest.approx(coriolis_matrix(robot, pose[4], velocity[4]), abs=1e-14)


def test_rotor_of_the_middle_actuator_counts(robot):
    # Without it the torques of thesis 3.3.1 are off in the sixth digit.
    from dataclasses import replace

    middle = replace(robot.legs[2], axis_inertia=0.0)
    without = replace(robot, legs=(*robot.legs[:2], middle))
    change = mass_matrix(robot, robot.home) - mass_matrix(without, robot.home)
    assert change[:2, :2] == pytest.approx(np.full((2, 2), 14.81e-7 / 2), rel=1e-9)


def test_gravity_turns_with_the_base(robot):
    # Thesis 3.40: a negative tilt raises the +x side.
    x, y, z = robot.tilted(np.radians(-30)).gravity_vector
    assert (x, y, z) == pytest.approx((-9.81 / 2, 0, -9.81 * np.sqrt(3) / 2))
