"""Whether a robot can move as a body with mass: what a spec that is well written may still lack."""

from __future__ import annotations

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.robot.models.dynamics import mass_matrix
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array

# Least over largest eigenvalue of M below which a direction of motion counts as without inertia.
SINGULAR = 1e-9


def examine_inertia(robot: Robot) -> Array:
    """Return the eigenvalues of the mass matrix in the middle of the workspace, rising, in kg m^2.

    A motion without inertia, to whose acceleration no torque belongs, is a `DesignError`.
    """
    eigenvalues = np.linalg.eigvalsh(mass_matrix(robot, robot.home))
    if not eigenvalues[0] > SINGULAR * eigenvalues[-1]:
        raise DesignError(
            "the mass matrix in the middle of the workspace is singular: some motion of the robot "
            "moves no mass",
            remedy="check the masses of legs and platform",
            at=("legs",),
        )
    return np.asarray(eigenvalues, dtype=np.float64)
