"""Recomputed values of the NeuRoboScope (thesis chapter 3, with its misprints corrected)."""

import numpy as np
import pytest

from nrs_design.robot.models import (
    direct_kinematics,
    gravity_torque,
    inverse_dynamics,
    inverse_kinematics,
    mass_matrix,
)

POSES = np.array([(0, 0, 0.2), (0.1, -0.2, 0.2)])


def test_kinematics(robot):
    joints = [0.21320221, -0.07155944, 0.80477127]
    assert inverse_kinematics(robot, POSES[1]) == pytest.approx(joints, abs=1e-8)
    found = direct_kinematics(robot, inverse_kinematics(robot, POSES[1]))
    assert found == pytest.approx(POSES[1], abs=1e-14)


@pytest.mark.parametrize(("d", "degrees"), [(0.15, 3.822554), (0.2, 21.967097), (0.25, 39.241659)])
def test_crank_angle(robot, d, degrees):
    theta = inverse_kinematics(robot, (0, 0, d))
    assert np.degrees(theta) == pytest.approx([0, 0, degrees], abs=1e-6)


def test_dynamics(robot):
    """One motion may go with several poses."""
    weights = [[-3.334268, 3.327126, 2.913252], [-3.500254, 2.962601, 2.683968]]
    torques = [[-3.271875, 3.503217, 2.917228], [-3.412764, 3.142030, 2.681441]]
    moved = inverse_dynamics(robot, POSES, (0.5, -0.3, 0.8), (1, 2, -1))
    assert gravity_torque(robot, POSES) == pytest.approx(np.array(weights), abs=1e-6)
    assert moved == pytest.approx(np.array(torques), abs=1e-6)
    diagonal = np.diag(mass_matrix(robot, POSES[0]))
    assert diagonal == pytest.approx([0.146025, 0.145811, 0.047898], abs=1e-6)
