"""Velocities and accelerations of every link that follow from those of the joints or the pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.geometry import LegPosture, Posture
from nrs_design.robot.models.vectors import Scalar, Vector, add, components, dot, scale


@dataclass(frozen=True, slots=True)
class LegMotion:
    """Rates of one leg: plane angle, endoscope, crank, coupler; ``_2`` is a second derivative."""

    alpha_1: Scalar
    gamma_1: Scalar
    beta_1: Scalar
    kappa_1: Scalar
    alpha_2: Scalar
    gamma_2: Scalar
    beta_2: Scalar
    kappa_2: Scalar


@dataclass(frozen=True, slots=True)
class RobotMotion:
    """Rates of the robot: direction W of the endoscope, depth d, and the legs."""

    W_1: Vector
    d_1: Scalar
    d_2: Scalar
    legs: tuple[LegMotion, LegMotion, LegMotion]


def joint_driven(closed: Posture, velocity: ArrayLike, acceleration: ArrayLike) -> RobotMotion:
    """Return the motion that rates of the joints make, in rad/s and rad/s^2."""
    v, a = components(velocity), components(acceleration)
    left, right, middle = closed.legs
    W_1 = add(scale(left.sin_gamma * v[0], closed.u1), scale(right.sin_gamma * v[1], closed.u2))
    pushes = [
        leg.sin_gamma * a[i] + 2 * leg.cos_gamma * _gamma_1(leg, W_1) * v[i]
        for i, leg in enumerate((left, right))
    ]
    plane_part = add(scale(pushes[0], closed.u1), scale(pushes[1], closed.u2))
    # W stays a unit vector.
    W_2 = add(plane_part, scale(-dot(W_1, W_1), closed.W))
    gamma_1, gamma_2 = _gamma_rates(middle, W_1, W_2)
    d_1 = (v[2] - middle.beta_gamma * gamma_1) / middle.beta_d
    bias = _closure_bias(middle, gamma_1, d_1)[0]
    d_2 = (a[2] - middle.beta_gamma * gamma_2 - bias) / middle.beta_d
    return _motion(closed, W_1, W_2, d_1, d_2, ((v[0], a[0]), (v[1], a[1])))


def pose_driven(
    closed: Posture, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> RobotMotion:
    """Return the motion that the rates of (phi, psi, d) make; shapes (..., 3), rad, m and s."""
    phi, psi, _ = components(pose)
    v, a = components(velocity), components(acceleration)
    x_1 = np.cos(psi) * v[1]
    x_2 = np.cos(psi) * a[1] - np.sin(psi) * v[1] ** 2
    y_1 = -np.cos(phi) * v[0]
    y_2 = -np.cos(phi) * a[0] + np.sin(phi) * v[0] ** 2
    W = closed.W
    z_1 = -(W[0] * x_1 + W[1] * y_1) / W[2]
    z_2 = -(W[0] * x_2 + W[1] * y_2 + x_1**2 + y_1**2 + z_1**2) / W[2]
    return _motion(closed, (x_1, y_1, z_1), (x_2, y_2, z_2), v[2], a[2])


# Rate and acceleration of the plane of a leg.
_Turn = tuple[Scalar, Scalar]


def _motion(
    closed: Posture,
    W_1: Vector,
    W_2: Vector,
    d_1: Scalar,
    d_2: Scalar,
    turns: tuple[_Turn | None, _Turn | None] = (None, None),
) -> RobotMotion:
    left, right, middle = (
        _leg_motion(leg, W_1, W_2, d_1, d_2, turn)
        for leg, turn in zip(closed.legs, (*turns, None), strict=True)
    )
    return RobotMotion(W_1, d_1, d_2, (left, right, middle))


def _leg_motion(
    leg: LegPosture, W_1: Vector, W_2: Vector, d_1: Scalar, d_2: Scalar, turn: _Turn | None
) -> LegMotion:
    gamma_1, gamma_2 = _gamma_rates(leg, W_1, W_2)
    alpha_1, alpha_2 = turn or _turn_of(leg, W_1, W_2, gamma_1)
    beta_bias, kappa_bias = _closure_bias(leg, gamma_1, d_1)
    return LegMotion(
        alpha_1=alpha_1,
        gamma_1=gamma_1,
        beta_1=leg.beta_gamma * gamma_1 + leg.beta_d * d_1,
        kappa_1=leg.kappa_gamma * gamma_1 + leg.kappa_d * d_1,
        alpha_2=alpha_2,
        gamma_2=gamma_2,
        beta_2=leg.beta_gamma * gamma_2 + leg.beta_d * d_2 + beta_bias,
        kappa_2=leg.kappa_gamma * gamma_2 + leg.kappa_d * d_2 + kappa_bias,
    )


def _turn_of(leg: LegPosture, W_1: Vector, W_2: Vector, gamma_1: Scalar) -> _Turn:
    """Return how the plane turns, where the endoscope moves and no joint of the plane says it."""
    alpha_1 = dot(leg.normal, W_1) / leg.sin_gamma
    tangential = dot(leg.normal, W_2) - 2 * leg.cos_gamma * gamma_1 * alpha_1
    return alpha_1, tangential / leg.sin_gamma


def _gamma_1(leg: LegPosture, W_1: Vector) -> Scalar:
    return -dot(leg.leg.axis, W_1) / leg.sin_gamma


def _gamma_rates(leg: LegPosture, W_1: Vector, W_2: Vector) -> tuple[Scalar, Scalar]:
    """From ``cos(gamma) = a . W``, differentiated twice."""
    gamma_1 = _gamma_1(leg, W_1)
    gamma_2 = -(dot(leg.leg.axis, W_2) + leg.cos_gamma * gamma_1 * gamma_1) / leg.sin_gamma
    return gamma_1, gamma_2


def _closure_bias(leg: LegPosture, gamma_1: Scalar, d_1: Scalar) -> tuple[Scalar, Scalar]:
    """Accelerations of crank and coupler that velocities alone make, to keep the loop closed."""
    l1, l2 = leg.leg.l1, leg.leg.l2
    beta_1 = leg.beta_gamma * gamma_1 + leg.beta_d * d_1
    kappa_1 = leg.kappa_gamma * gamma_1 + leg.kappa_d * d_1
    square, coriolis = gamma_1 * gamma_1, 2 * gamma_1 * d_1
    x = -leg.end[0] * square - coriolis * leg.sin_gamma
    y = -leg.end[1] * square + coriolis * leg.cos_gamma
    beta_pull, kappa_pull = l1 * beta_1 * beta_1, l2 * kappa_1 * kappa_1
    beta_bias = leg.cos_kappa * x + leg.sin_kappa * y + beta_pull * leg.cos_elbow + kappa_pull
    kappa_bias = leg.cos_beta * x + leg.sin_beta * y + beta_pull + kappa_pull * leg.cos_elbow
    return beta_bias / (l1 * leg.sin_elbow), -kappa_bias / (l2 * leg.sin_elbow)
