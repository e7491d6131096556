"""How much of the torque is due to gravity, to velocities and to accelerations (thesis 3.3)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.dynamics import gravity_torque, inverse_dynamics
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array

# Thesis 3.3 takes these for the largest joint velocity (rad/s) and acceleration (rad/s^2).
THESIS_VELOCITY = 2.0094
THESIS_ACCELERATION = 7.4172


@dataclass(frozen=True, slots=True)
class TorqueShares:
    """Shares between 0 and 1 for each pose and joint, shape (..., 3); they add up to 1."""

    gravity: Array
    coriolis: Array
    inertia: Array

    @property
    def means(self) -> tuple[float, float, float]:
        """Mean over poses and joints of gravity, Coriolis and inertia."""
        gravity, coriolis, inertia = (
            float(np.mean(part)) for part in (self.gravity, self.coriolis, self.inertia)
        )
        return gravity, coriolis, inertia


def torque_shares(
    robot: Robot,
    pose: ArrayLike,
    velocity: ArrayLike = (THESIS_VELOCITY,) * 3,
    acceleration: ArrayLike = (THESIS_ACCELERATION,) * 3,
) -> TorqueShares:
    """Return the shares of the magnitudes of the three kinds of torque (thesis fig. 3.8).

    Velocity and acceleration are of the joints; by default those of the thesis for all joints.
    """
    gravity = gravity_torque(robot, pose)
    bias = inverse_dynamics(robot, pose, velocity, np.zeros(3))
    total = inverse_dynamics(robot, pose, velocity, acceleration)
    parts = [np.abs(part) for part in (gravity, bias - gravity, total - bias)]
    return TorqueShares(*(part / sum(parts) for part in parts))
