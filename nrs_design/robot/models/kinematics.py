"""Direct and inverse kinematics, Jacobians, and how near the robot is to a singularity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.geometry import LegPosture, PoseError, Posture, posture
from nrs_design.robot.models.motion import joint_driven, pose_driven
from nrs_design.robot.models.robot import Leg, Robot
from nrs_design.robot.models.vectors import Array, Scalar, Vector, components, cross, dot, stack


@dataclass(frozen=True, slots=True)
class JointMotion:
    """Angles, velocities and accelerations of the joints; shape (..., 3), rad and s."""

    position: Array
    velocity: Array
    acceleration: Array

    def select(self, index: int | list[int]) -> JointMotion:
        """Return the motion at one place of the first axis, or at some."""
        return JointMotion(self.position[index], self.velocity[index], self.acceleration[index])


def inverse_kinematics(robot: Robot, pose: ArrayLike) -> Array:
    """Return the joint angles of a pose in rad (thesis 3.8 to 3.10, the last one corrected)."""
    return joint_angles(posture(robot, pose))


def joint_angles(closed: Posture) -> Array:
    """Return the joint angles of a robot whose loops are closed; shape (..., 3), in rad."""
    left, right, middle = closed.legs
    theta3 = np.arctan2(middle.sin_beta, middle.cos_beta)
    angles = (_plane_angle(left.leg, closed.W), _plane_angle(right.leg, closed.W), theta3)
    return np.asarray(stack(angles), dtype=np.float64)


def _plane_angle(leg: Leg, W: Vector) -> Scalar:
    """Angle by which the leg's plane has turned about its base axis from the vertical."""
    a = leg.axis
    return np.arctan2(a[1] * W[0] - a[0] * W[1], W[2])


def direct_kinematics(robot: Robot, joints: ArrayLike) -> Any:
    """Return the pose of given joint angles in rad (thesis 3.4 to 3.7).

    The coupler of the middle leg points the way it does in the middle of the workspace. Complex
    angles are continued analytically, so that derivatives may be taken by complex steps.
    """
    theta = components(joints)
    normals = [_plane_normal(leg, angle) for leg, angle in zip(robot.legs, theta[:2], strict=False)]
    N = cross(*normals)
    length = np.sqrt(dot(N, N))
    # Either of two opposite directions lies in both planes: the endoscope points upwards.
    length = np.where(np.real(N[2]) > 0, length, -length)
    W = (N[0] / length, N[1] / length, N[2] / length)
    d = _depth(robot, W, theta[2])
    return stack((np.arcsin(-W[1]), np.arcsin(W[0]), d))


def _plane_normal(leg: Leg, angle: Scalar) -> Vector:
    a = leg.axis
    sin, cos = np.sin(angle), np.cos(angle)
    return cross(a, (a[1] * sin, -a[0] * sin, cos))


def _depth(robot: Robot, W: Vector, theta3: Scalar) -> Scalar:
    leg = robot.legs[2]
    cos_gamma = dot(leg.axis, W)
    sin_gamma = np.sqrt(1.0 - cos_gamma * cos_gamma)
    x, y = leg.l0 + leg.l1 * np.cos(theta3), leg.l1 * np.sin(theta3)
    axial = x * cos_gamma + y * sin_gamma
    transverse = leg.l3 - (x * sin_gamma - y * cos_gamma)
    square = leg.l2**2 - transverse * transverse
    if not np.all(np.real(square) >= 0):
        lack = float(np.max(np.abs(np.real(transverse)))) - leg.l2
        raise PoseError(
            f"no pose has these joint angles: the elbow of the {leg.name} leg is {1e3 * lack:.4g} "
            "mm too far from the endoscope axis",
            remedy="check the joint angles, in rad",
        )
    # Direction of the coupler: along the endoscope, or against the endoscope.
    sign = np.sign(_coupler_along(posture(robot, robot.home).legs[2]))
    return axial + sign * np.sqrt(square)


def _coupler_along(leg: LegPosture) -> Scalar:
    return leg.cos_kappa * leg.cos_gamma + leg.sin_kappa * leg.sin_gamma


def jacobian(robot: Robot, pose: ArrayLike) -> Array:
    """Return J_n with ``(phi', psi', d') = J_n q'`` (thesis 3.14)."""
    closed = posture(robot, pose)
    phi, psi, _ = components(pose)
    columns = []
    for unit in np.eye(3):
        motion = joint_driven(closed, unit, np.zeros(3))
        rates = (-motion.W_1[1] / np.cos(phi), motion.W_1[0] / np.cos(psi), motion.d_1)
        columns.append(stack(rates))
    return np.stack(columns, axis=-1)


def inverse_jacobian(robot: Robot, pose: ArrayLike) -> Array:
    """Return the inverse of J_n, ``q' = J_n^-1 (phi', psi', d')``; shape (..., 3, 3)."""
    columns = [joint_motion(robot, pose, unit, np.zeros(3)).velocity for unit in np.eye(3)]
    return np.stack(columns, axis=-1)


def orientation(pose: ArrayLike) -> Array:
    """Return (theta_x, theta_y, d) of a pose: ``R = Rx(theta_x) Ry(theta_y)`` turns z into W.

    ``theta_x = asin(sin(phi)/cos(psi))``, ``theta_y = psi``; thesis 3.16 has them exchanged.
    """
    phi, psi, d = components(pose)
    return np.asarray(stack((np.arcsin(np.sin(phi) / np.cos(psi)), psi, d)), dtype=np.float64)


def orientation_jacobian(pose: ArrayLike) -> Array:
    """Return J_xy with ``(theta_x', theta_y', d') = J_xy (phi', psi', d')`` (3.17, corrected)."""
    phi, psi, _ = components(pose)
    r = np.sqrt(1.0 - (np.sin(phi) / np.cos(psi)) ** 2)
    J = np.zeros((*np.shape(phi), 3, 3))
    J[..., 0, 0] = np.cos(phi) / (np.cos(psi) * r)
    J[..., 0, 1] = np.sin(phi) * np.sin(psi) / (np.cos(psi) ** 2 * r)
    J[..., 1, 1] = J[..., 2, 2] = 1.0
    return J


def joint_motion(
    robot: Robot, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> JointMotion:
    """Return the exact motion of the joints that moves the pose (phi, psi, d) as wanted."""
    closed = posture(robot, pose)
    left, right, middle = pose_driven(closed, pose, velocity, acceleration).legs
    return JointMotion(
        joint_angles(closed),
        stack((left.alpha_1, right.alpha_1, middle.beta_1)),
        stack((left.alpha_2, right.alpha_2, middle.beta_2)),
    )


def coupler_margin(robot: Robot, pose: ArrayLike) -> Array:
    """Return |cosine| of the angle between each leg's coupler and the endoscope, shape (..., 3).

    Where that of the middle leg vanishes, its crank has no hold on the depth: the pose is singular.
    """
    left, right, middle = (np.abs(_coupler_along(leg)) for leg in posture(robot, pose).legs)
    return np.asarray(stack((left, right, middle)))
