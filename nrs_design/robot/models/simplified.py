"""Simplified dynamics: nothing but the platform and the rotor of the middle leg (thesis 3.3).

The platform's angular velocity is ``(theta_x', cos(theta_x) theta_y', sin(theta_x) theta_y')``;
thesis 3.33 leaves the cosine and the sine out. It is written here with the base axis of the middle
leg, about which the platform turns by theta_x, and its own y axis, so that it holds for every
azimuth of that leg.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.geometry import Posture, posture
from nrs_design.robot.models.motion import joint_driven
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array, cross, scale, stacked


@dataclass(frozen=True, slots=True)
class SimplifiedDynamics:
    """Ms in kg m^2, shape (..., 3, 3), and Gs in N m, shape (..., 3)."""

    Ms: Array
    Gs: Array


def simplified_dynamics(
    robot: Robot, pose: ArrayLike, *, printed: bool = False
) -> SimplifiedDynamics:
    """Return Ms and Gs (thesis 3.35 and 3.37), which the robot can compute at every tick.

    Of the robot only platform and axis inertia of the middle leg count. `printed` takes the angular
    velocity as printed in 3.33, ``(theta_x', theta_y', 0)``, to reproduce the thesis.
    """
    closed = posture(robot, pose)
    frame, body = _platform_frame(closed), robot.platform
    rates = _rates(closed)
    about_x = np.broadcast_to(robot.legs[2].axis, frame.shape[:-1])
    about_y = frame[..., :, 1]
    arm = frame @ body.center_of_mass + np.asarray(closed.d)[..., None] * frame[..., :, 2]
    linear = _columns(np.cross(about_x, arm), np.cross(about_y, arm), frame[..., :, 2]) @ rates
    if printed:
        about_y = np.broadcast_to(np.cross((0.0, 0.0, 1.0), robot.legs[2].axis), about_y.shape)
    angular = _columns(about_x, about_y, np.zeros_like(about_x)) @ rates
    Ms = (
        body.mass * linear.mT @ linear
        + angular.mT @ frame @ body.inertia @ frame.mT @ angular
        + robot.legs[2].axis_inertia * rates[..., 0, :, None] * rates[..., 0, None, :]
    )
    Gs = -body.mass * linear.mT @ np.asarray(robot.gravity_vector)
    return SimplifiedDynamics(Ms, Gs)


def _rates(closed: Posture) -> Array:
    """Jacobian of (theta_x, theta_y, d) of the platform; shape (..., 3, 3)."""
    units = np.eye(3).reshape(3, *(1 for _ in np.shape(closed.d)), 3)
    motion = joint_driven(closed, units, np.zeros(3))
    middle = motion.legs[2]
    columns = stacked((middle.alpha_1, -middle.gamma_1, motion.d_1))
    return np.asarray(np.moveaxis(columns, 0, -1), dtype=np.float64)


def _platform_frame(closed: Posture) -> Array:
    """Rotation from the platform's frame to the base frame; shape (..., 3, 3)."""
    middle = closed.legs[2]
    y = scale(-1.0, middle.normal)
    x = cross(y, closed.W)
    return np.stack([stacked(x), stacked(y), stacked(closed.W)], axis=-1)


def _columns(*vectors: Array) -> Array:
    return np.stack(vectors, axis=-1)
