"""Inertia and gravity corrected apart, which chapter 8 of the thesis proposes."""

import numpy as np
import pytest

from nrs_design.robot.models import (
    correct_separately,
    gravity_torque,
    mass_matrix,
    simplified_dynamics,
    thesis_grid,
)

POSES = thesis_grid()[::7]


def test_what_it_gains(robot):
    """Recomputed over the poses of thesis 3.3."""
    found = correct_separately(robot, thesis_grid())
    errors = (found.single_error, found.rows_error, found.entries_error, found.gravity_error)
    assert errors == pytest.approx((0.1165, 0.0828, 0.0338, 0.0227), abs=1e-4)


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
