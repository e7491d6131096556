"""Closed loops: position of every link at a pose, and reach.

Each leg is a slider-crank in a plane that is spanned by its base axis ``a`` and the endoscope
``W`` (thesis fig. 3.3 and 3.4). In that plane angles count from ``a`` towards ``W``: beta of the
crank, kappa of the coupler, gamma of the endoscope. The plane turns about ``a`` by alpha. Its frame
is ``a, b, k`` with ``W = cos(gamma) a + sin(gamma) b`` and ``k = a x b``.

A pose is (phi, psi, d) in rad and m, shape (..., 3); of every pose that a leg cannot reach, all
that follows from it is a `PoseError`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nrs_design.errors import NrsDesignError
from nrs_design.robot.models.robot import Leg, Robot
from nrs_design.robot.models.vectors import Array, Scalar, Vector, components, cross, dot, scale


class PoseError(NrsDesignError):
    """A pose that the robot cannot take."""

    rule = "NRS007"


@dataclass(frozen=True, slots=True)
class LegPosture:
    """Directions within the plane of one leg, and how crank and coupler follow the endoscope."""

    leg: Leg  # The leg
    normal: Vector  # Normal k of the plane
    # cos_gamma, sin_gamma, cos_beta, sin_beta, cos_kappa, sin_kappa: directions of endoscope, crank
    # and coupler.
    cos_gamma: Scalar
    sin_gamma: Scalar
    cos_beta: Scalar
    sin_beta: Scalar
    cos_kappa: Scalar
    sin_kappa: Scalar
    end: tuple[Scalar, Scalar]  # Coupler's end in the plane, in m
    # Derivative of the end with respect to gamma; the derivative with respect to d is (cos gamma,
    # sin gamma).
    end_gamma: tuple[Scalar, Scalar]
    # sin_elbow, cos_elbow: of the angle kappa - beta.
    sin_elbow: Scalar
    cos_elbow: Scalar
    # beta_gamma, beta_d, kappa_gamma, kappa_d: partial derivatives of crank and coupler angle.
    beta_gamma: Scalar
    beta_d: Scalar
    kappa_gamma: Scalar
    kappa_d: Scalar


@dataclass(frozen=True, slots=True)
class Posture:
    """Posture of the robot at a pose, or at each pose of a batch."""

    W: Vector  # Direction of the endoscope in the base frame (thesis 3.3)
    d: Scalar  # Depth in m
    legs: tuple[LegPosture, LegPosture, LegPosture]  # Left, right, middle
    # Velocity of W per unit of ``sin(gamma) alpha'`` of the left and the right leg.
    u1: Vector
    u2: Vector


def direction(pose: ArrayLike) -> Vector:
    """Return W, the direction of the endoscope (thesis 3.3).

    There is none unless ``sin(phi)^2 + sin(psi)^2`` is below 1, and a `PoseError` instead.
    """
    phi, psi, _ = components(pose)
    if not np.all(np.isfinite(pose)):
        raise PoseError("a pose is not finite", remedy="check phi, psi and d")
    x, y = np.sin(psi), -np.sin(phi)
    square = 1.0 - x * x - y * y
    if not np.all(square > 0):
        raise _no_direction(pose, square)
    return x, y, np.sqrt(square)


def posture(robot: Robot, pose: ArrayLike) -> Posture:
    """Close the loops of all legs; a `PoseError` names the leg that does not reach."""
    W, d = direction(pose), components(pose)[2]
    left, right, middle = (_leg_posture(leg, W, d) for leg in robot.legs)
    if not all(np.all(np.abs(leg.sin_elbow) > 0) for leg in (left, right, middle)):
        raise unreachable(robot, pose)
    inverse = 1.0 / dot(W, cross(left.normal, right.normal))
    u1 = scale(inverse, cross(right.normal, W))
    u2 = scale(inverse, cross(W, left.normal))
    return Posture(W, d, (left, right, middle), u1, u2)


def _leg_posture(leg: Leg, W: Vector, d: Scalar) -> LegPosture:
    a, l1, l2, l3 = leg.axis, leg.l1, leg.l2, leg.l3
    cos_gamma, sin_gamma, end = _coupler_end(leg, W, d)
    normal = scale(1.0 / sin_gamma, cross(a, W))
    end_gamma = (l3 * cos_gamma - d * sin_gamma, l3 * sin_gamma + d * cos_gamma)
    x, y = end[0] - leg.l0, end[1]
    cos_beta, sin_beta = _crank(leg, x, y)
    cos_kappa, sin_kappa = (x - l1 * cos_beta) / l2, (y - l1 * sin_beta) / l2
    sin_elbow = sin_kappa * cos_beta - cos_kappa * sin_beta
    with np.errstate(divide="ignore", invalid="ignore"):
        per_l1 = 1.0 / (l1 * sin_elbow)
        per_l2 = -(l1 / l2) * per_l1
        return LegPosture(
            leg=leg,
            normal=normal,
            cos_gamma=cos_gamma,
            sin_gamma=sin_gamma,
            cos_beta=cos_beta,
            sin_beta=sin_beta,
            cos_kappa=cos_kappa,
            sin_kappa=sin_kappa,
            end=end,
            end_gamma=end_gamma,
            sin_elbow=sin_elbow,
            cos_elbow=cos_kappa * cos_beta + sin_kappa * sin_beta,
            beta_gamma=(cos_kappa * end_gamma[0] + sin_kappa * end_gamma[1]) * per_l1,
            beta_d=(cos_kappa * cos_gamma + sin_kappa * sin_gamma) * per_l1,
            kappa_gamma=(cos_beta * end_gamma[0] + sin_beta * end_gamma[1]) * per_l2,
            kappa_d=(cos_beta * cos_gamma + sin_beta * sin_gamma) * per_l2,
        )


def _crank(leg: Leg, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
    """Cosine and sine of the crank angle, from the coupler's end seen from the base joint."""
    square = x * x + y * y
    # The elbow in components along and across the line between the two.
    axial = (leg.l1 * leg.l1 + square - leg.l2 * leg.l2) / (2 * leg.l1)
    with np.errstate(invalid="ignore"):
        transverse = leg.elbow_sign * np.sqrt(square - axial * axial)
    return (x * axial - y * transverse) / square, (y * axial + x * transverse) / square


def reach(robot: Robot, pose: ArrayLike) -> Array:
    """Return the distance in m of base joint and coupler's end, of left, right and middle leg.

    The pose need not be reachable.
    """
    W, d = direction(pose), components(pose)[2]
    ends = ((leg, _coupler_end(leg, W, d)[2]) for leg in robot.legs)
    return np.stack([np.hypot(u - leg.l0, v) for leg, (u, v) in ends], axis=-1)


def reach_margin(robot: Robot, pose: ArrayLike) -> Array:
    """Return the margin of every leg to its reach in m, shape (..., 3); zero is singular.

    The smaller of the distances from stretched and from folded, negative where the leg would have
    to be overstretched or folded beyond its limit.
    """
    distance = reach(robot, pose)
    longest = np.array([leg.longest for leg in robot.legs])
    shortest = np.array([leg.shortest for leg in robot.legs])
    return np.asarray(np.minimum(longest - distance, distance - shortest))


def is_reachable(robot: Robot, pose: ArrayLike) -> NDArray[np.bool_]:
    """Tell for every pose whether all legs reach it strictly; shape (...)."""
    return np.asarray(np.all(reach_margin(robot, pose) > 0, axis=-1))


def _coupler_end(leg: Leg, W: Vector, d: Scalar) -> tuple[Scalar, Scalar, tuple[Scalar, Scalar]]:
    """Return cosine and sine of gamma, and the coupler's end in the plane of the leg, in m."""
    cos_gamma = dot(leg.axis, W)
    sin_gamma = np.sqrt(1.0 - cos_gamma * cos_gamma)
    end = d * cos_gamma + leg.l3 * sin_gamma, d * sin_gamma - leg.l3 * cos_gamma
    return cos_gamma, sin_gamma, end


def unreachable(robot: Robot, pose: ArrayLike) -> PoseError:
    """Describe the worst leg at the worst pose of a batch."""
    poses = np.asarray(pose, dtype=float).reshape(-1, 3)
    margins = reach_margin(robot, poses).reshape(-1, 3)
    # A pose at the very limit has no margin, and no velocities either.
    row, column = divmod(int(np.argmin(margins)), 3)
    leg = robot.legs[column]
    distance = float(reach(robot, poses[row])[column])
    is_stretched = distance > (leg.longest + leg.shortest) / 2
    limit = leg.longest if is_stretched else leg.shortest
    excess = abs(distance - limit)
    defect = "overstretched" if is_stretched else "folded too far"
    phi, psi, d = poses[row]
    return PoseError(
        f"the pose phi {np.degrees(phi):.4g} deg, psi {np.degrees(psi):.4g} deg, d {1e3 * d:.4g} "
        f"mm is not reachable: the {leg.name} leg is {defect} by {1e3 * excess:.4g} mm (base joint "
        f"to coupler's end {1e3 * distance:.6g} mm, limit {1e3 * limit:.6g} mm)",
        remedy="choose a depth or an angle within the workspace; see `nrs-design robot kinematics`",
    )


def _no_direction(pose: ArrayLike, square: Array) -> PoseError:
    poses = np.asarray(pose, dtype=float).reshape(-1, 3)
    row = int(np.argmin(square))
    phi, psi, _ = poses[row]
    return PoseError(
        f"phi {np.degrees(phi):.4g} deg and psi {np.degrees(psi):.4g} deg give no direction of the "
        "endoscope: sin(phi)^2 + sin(psi)^2 must be below 1",
        remedy="choose smaller angles, in rad",
    )
