"""Chapter 3.1: kinematics, its misprints, and the joint speeds of 3.3."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nrs_design.robot.models.geometry import direction
from nrs_design.robot.models.kinematics import (
    inverse_jacobian,
    inverse_kinematics,
    orientation,
    orientation_jacobian,
)
from nrs_design.robot.models.neuroboscope import robot
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.models.workspace import joint_peaks, pose_grid, thesis_grid
from nrs_design.thesis.comparison import Found, Recomputed

POSE = (0.1, -0.2, 0.2)
_ROUNDING = 1e-12
# In 1/s: both accelerations of the task that 3.3 prints over their speeds.
ACCELERATION_PER_SPEED = 3.7


def results() -> Iterator[Found]:
    """Recompute the crank angle, the orientation and the joint speeds."""
    ours = robot()
    yield float(inverse_kinematics(ours, POSE)[2])
    space = ours.workspace
    poses = pose_grid([0.0], (-space.psi, 0.0, space.psi), np.linspace(*space.d, 101))
    crank = np.degrees(inverse_kinematics(ours, poses)[..., 2])
    yield float(crank.min()), float(crank.max())
    yield from _orientation()
    yield from _speeds(ours)


def _orientation() -> Iterator[Recomputed]:
    pose = np.array(POSE)
    W = np.array(direction(pose))
    phi, psi, _ = POSE
    printed = _pointing(phi, float(np.arcsin(np.sin(psi) / np.cos(phi))))
    x, y, _ = orientation(pose)
    ours, theirs = (float(np.abs(z - W).max()) for z in (_pointing(float(x), float(y)), printed))
    yield Recomputed(None, ours < _ROUNDING < theirs, (f"{theirs:.2g}",))
    step = 1e-6
    slopes = np.stack(
        [
            (orientation(pose + step * unit) - orientation(pose - step * unit)) / (2 * step)
            for unit in np.eye(3)
        ],
        axis=-1,
    )
    J = orientation_jacobian(pose)
    exchanged = np.abs(J[[1, 0, 2]] - slopes).max()
    yield Recomputed(holds=bool(np.abs(J - slopes).max() < 1e-8 < exchanged))


def _pointing(x: float, y: float) -> Array:
    """Third column of Rx(x) Ry(y)."""
    return np.array([np.sin(y), -np.sin(x) * np.cos(y), np.cos(x) * np.cos(y)])


def _speeds(ours: Robot) -> Iterator[Found]:
    limits, per_speed = ours.task_limits, ACCELERATION_PER_SPEED
    yield float(np.degrees(limits.angular_velocity))
    yield per_speed * limits.angular_velocity, 1e3 * per_speed * limits.linear_velocity
    v = np.array([limits.angular_velocity] * 2 + [limits.linear_velocity])
    depths = np.linspace(*ours.workspace.d, 1001)
    upright = np.stack([0 * depths, 0 * depths, depths], axis=-1)
    crank = np.abs(inverse_jacobian(ours, upright) @ v)[:, 2]
    yield Recomputed(float(crank.min()), facts=(f"{1e3 * depths[crank.argmin()]:.0f}",))
    peaks = joint_peaks(ours, thesis_grid())
    yield tuple(float(speed) for speed in peaks.velocity)
    largest = ", ".join(f"{value:.2f}" for value in peaks.acceleration)
    yield Recomputed(per_speed * 2.0094, facts=(largest,))
