"""Inertia and gravity corrected apart, which chapter 8 of the thesis proposes."""

import numpy as np

from nrs_design.robot.models.correction import correct_separately
from nrs_design.robot.models.dynamics import gravity_torque, mass_matrix
from nrs_design.robot.models.simplified import simplified_dynamics
from nrs_design.robot.models.workspace import thesis_grid

POSES = thesis_grid()[::7]


def test_no_other_coefficients_leave_less(robot):
    found = correct_separately(robot, POSES)
    M, Ms = mass_matrix(robot, POSES), simplified_dynamics(robot, POSES).Ms
    G, Gs = gravity_torque(robot, POSES), simplified_dynamics(robot, POSES).Gs
    for step in (-0.01, 0.01):
        for k in range(3):
            unit = np.eye(3)[k]
            gravity = np.linalg.norm(G - (found.gravity + step * unit) * Gs)
            assert gravity > found.gravity_error * np.linalg.norm(G)
            rows = np.linalg.norm(M - (found.inertia_rows + step * unit)[:, None] * Ms)
            assert rows > found.rows_error * np.linalg.norm(M)
