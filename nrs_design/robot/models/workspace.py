"""The workspace (thesis 3.3): grids of poses, how fast the joints must be, and where M is sound."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.errors import DesignError
from nrs_design.robot.models.dynamics import mass_matrix
from nrs_design.robot.models.geometry import (
    PoseError,
    is_reachable,
    posture,
    reach_margin,
    unreachable,
)
from nrs_design.robot.models.kinematics import (
    coupler_margin,
    inverse_jacobian,
    inverse_kinematics,
    joint_motion,
)
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array

_DEGREE = np.radians(1.0)
# Values of phi and of psi, and of d, in a survey.
_ANGLES, _DEPTHS = 31, 21


def pose_grid(phi: ArrayLike, psi: ArrayLike, d: ArrayLike) -> Array:
    """Return every combination of three lists, in rad and m, as poses; shape (len, len, len, 3)."""
    return np.stack(np.meshgrid(phi, psi, d, indexing="ij"), axis=-1)


def workspace_grid(robot: Robot, angles: int = 31, depths: int = 11) -> Array:
    """Return a regular grid over the robot's workspace, of which not every pose is reachable."""
    space = robot.workspace
    return pose_grid(
        np.linspace(-space.phi, space.phi, angles),
        np.linspace(-space.psi, space.psi, angles),
        np.linspace(*space.d, depths),
    )


def reachable_poses(robot: Robot, pose: ArrayLike) -> Array:
    """Return the poses of a grid that all legs reach, shape (n, 3); none is a `PoseError`."""
    poses = np.asarray(pose, dtype=np.float64).reshape(-1, 3)
    reachable = poses[is_reachable(robot, poses)]
    if not len(reachable):
        raise unreachable(robot, poses)
    return reachable


def thesis_grid(depths: ArrayLike = (0.15, 0.2, 0.24)) -> Array:
    """Return the poses of thesis 3.3, angles within 14 and 19 deg by 1 deg; shape (n, 3)."""
    phi, psi = np.arange(-14, 15) * _DEGREE, np.arange(-19, 20) * _DEGREE
    return pose_grid(phi, psi, depths).reshape(-1, 3)


@dataclass(frozen=True, slots=True)
class WorkspaceSurvey:
    """Reach of the robot over the workspace of its spec."""

    reachable: float  # Share of the grid's poses that all legs reach, between 0 and 1
    # joint_low, joint_high: range of each joint over the reachable poses in rad, shape (3,).
    joint_low: Array
    joint_high: Array
    reach_margin: Array  # Least distance of each leg from stretched or folded in m, shape (3,)
    # Least |cosine| between each leg's coupler and the endoscope, shape (3,).
    coupler_margin: Array
    # (phi, psi, d) for each corner of the angles: the largest reachable d of the range, None where
    # no depth of the range is reachable.
    deepest: tuple[tuple[float, float, float | None], ...]
    # Obstacle at the farthest pose of the grid; None if all poses are reachable.
    obstacle: PoseError | None


def survey_workspace(robot: Robot) -> WorkspaceSurvey:
    """Examine the workspace of the spec, over the reachable poses of a regular grid."""
    posture(robot, robot.home)
    poses = workspace_grid(robot, _ANGLES, _DEPTHS).reshape(-1, 3)
    reachable = is_reachable(robot, poses)
    joints = inverse_kinematics(robot, poses[reachable])
    space = robot.workspace
    corners = product((-space.phi, space.phi), (-space.psi, space.psi))
    return WorkspaceSurvey(
        reachable=float(np.mean(reachable)),
        joint_low=joints.min(axis=0),
        joint_high=joints.max(axis=0),
        reach_margin=reach_margin(robot, poses[reachable]).min(axis=0),
        coupler_margin=coupler_margin(robot, poses[reachable]).min(axis=0),
        deepest=tuple((phi, psi, _deepest(robot, phi, psi)) for phi, psi in corners),
        obstacle=None if np.all(reachable) else unreachable(robot, poses[~reachable]),
    )


def _deepest(robot: Robot, phi: float, psi: float) -> float | None:
    """Largest reachable depth to a thousandth of the range, or the end of the range."""
    depths = np.linspace(*robot.workspace.d, 1001)
    poses = np.stack([np.full_like(depths, phi), np.full_like(depths, psi), depths], axis=-1)
    reachable = depths[is_reachable(robot, poses)]
    return float(reachable[-1]) if len(reachable) else None


def joint_peaks(robot: Robot, pose: ArrayLike) -> tuple[Array, Array]:
    """Return the largest velocity and acceleration of each joint within the task limits.

    In rad/s and rad/s^2, over the reachable poses. phi, psi and d move with their limits, each with
    the sign that asks most of the joint; accelerations include those that velocities alone make.
    """
    poses = reachable_poses(robot, pose)
    limits = robot.task_limits
    v = np.array([limits.angular_velocity] * 2 + [limits.linear_velocity])
    a = np.array([limits.angular_acceleration] * 2 + [limits.linear_acceleration])
    gain = np.abs(inverse_jacobian(robot, poses))
    corners = [
        np.abs(joint_motion(robot, poses, v * signs, np.zeros(3)).acceleration)
        # The bias is quadratic: opposite velocities have the same.
        for signs in product((1.0,), (1.0, -1.0), (1.0, -1.0))
    ]
    acceleration = gain @ a + np.max(corners, axis=0)
    return (gain @ v).max(axis=0), acceleration.max(axis=0)


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
