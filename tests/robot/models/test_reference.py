"""Recomputed values of the NeuRoboScope (thesis chapter 3, with its misprints corrected)."""

import numpy as np
import pytest

from nrs_design.robot.models import (
    coriolis_matrix,
    direct_kinematics,
    gravity_torque,
    inverse_dynamics,
    inverse_kinematics,
    mass_matrix,
)

HOME = (0, 0, 0.2)
ASIDE = (0.1, -0.2, 0.2)
VELOCITY = (0.5, -0.3, 0.8)
ACCELERATION = (1, 2, -1)


def test_inverse_kinematics(robot):
    expected = [0.21320221, -0.07155944, 0.80477127]
    assert inverse_kinematics(robot, ASIDE) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize(("d", "degrees"), [(0.15, 3.822554), (0.2, 21.967097), (0.25, 39.241659)])
def test_crank_angle(robot, d, degrees):
    theta = inverse_kinematics(robot, (0, 0, d))
    assert np.degrees(theta) == pytest.approx([0, 0, degrees], abs=1e-6)


def test_round_trip_to_the_last_digit(robot):
    joints = inverse_kinematics(robot, ASIDE)
    assert direct_kinematics(robot, joints) == pytest.approx(ASIDE, abs=1e-14)


@pytest.mark.parametrize(
    ("pose", "torque"),
    [(HOME, [-3.334268, 3.327126, 2.913252]), (ASIDE, [-3.500254, 2.962601, 2.683968])],
)
def test_gravity(robot, pose, torque):
    assert gravity_torque(robot, pose) == pytest.approx(torque, abs=1e-6)


@pytest.mark.parametrize(
    ("pose", "torque"),
    [(HOME, [-3.271875, 3.503217, 2.917228]), (ASIDE, [-3.412764, 3.142030, 2.681441])],
)
def test_inverse_dynamics(robot, pose, torque):
    found = inverse_dynamics(robot, pose, VELOCITY, ACCELERATION)
    assert found == pytest.approx(torque, abs=1e-6)
    C = coriolis_matrix(robot, pose, VELOCITY)
    parts = mass_matrix(robot, pose) @ ACCELERATION + C @ VELOCITY + gravity_torque(robot, pose)
    assert parts == pytest.approx(found, abs=1e-13)


def test_diagonal_of_the_mass_matrix(robot):
    found = np.diag(mass_matrix(robot, HOME))
    assert found == pytest.approx([0.146025, 0.145811, 0.047898], abs=1e-6)
