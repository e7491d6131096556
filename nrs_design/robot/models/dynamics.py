"""Full inverse dynamics of three legs and platform, by virtual work.

The inertial and gravitational forces on every link are reduced to the coordinates of its leg
(alpha, beta, kappa, gamma, d; see `nrs_design.robot.models.geometry`), from there to the direction
W and the depth d of the endoscope, and from there to the joints. No step solves an equation.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.body import (
    FIXED,
    Body,
    Direction,
    Plane,
    PlanePoint,
    first_moment,
    link_forces,
)
from nrs_design.robot.models.geometry import LegPosture, Posture, posture
from nrs_design.robot.models.motion import LegMotion, RobotMotion, joint_driven
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array, Scalar, Vector, add, dot, scale, stack

# Poses that are treated at once: their arrays stay in the processor's cache.
BATCH = 4096


def inverse_dynamics(
    robot: Robot, pose: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike
) -> Array:
    """Return the joint torques of a motion, ``M q'' + C q' + G``, shape (..., 3), in N m.

    Velocity and acceleration are those of the joints theta1, theta2, theta3, not of the pose.
    """
    arrays = np.broadcast_arrays(pose, velocity, acceleration)
    shape = arrays[0].shape
    x, v, a = (np.asarray(array, dtype=np.float64).reshape(-1, 3) for array in arrays)
    torques = np.empty_like(x)
    for start in range(0, len(x), BATCH):
        part = slice(start, start + BATCH)
        closed = posture(robot, x[part])
        motion = joint_driven(closed, v[part], a[part])
        torques[part] = _torque(closed, motion, robot)
    return torques.reshape(shape)


def gravity_torque(robot: Robot, pose: ArrayLike) -> Array:
    """Return G, the joint torques that hold the robot still; shape (..., 3), in N m."""
    return inverse_dynamics(robot, pose, np.zeros(3), np.zeros(3))


def mass_matrix(robot: Robot, pose: ArrayLike) -> Array:
    """Return M, symmetric and positive definite; shape (..., 3, 3), in kg m^2."""
    closed, weightless = posture(robot, pose), replace(robot, gravity=0.0)
    return _per_unit(
        lambda unit: _torque(closed, joint_driven(closed, np.zeros(3), unit), weightless), closed
    )


def coriolis_matrix(robot: Robot, pose: ArrayLike, velocity: ArrayLike) -> Array:
    """Return C with the Coriolis and centripetal torques ``C q'``, in N m s/rad; q' of the joints.

    These torques are a quadratic form of the velocities. C is made of its symmetric bilinear form,
    which has the Christoffel symbols for coefficients, so that ``dM/dt - 2 C`` is skew-symmetric.
    """
    closed, weightless = posture(robot, pose), replace(robot, gravity=0.0)
    v = np.asarray(velocity, dtype=np.float64)

    def quadratic(rates: Array) -> Array:
        return _torque(closed, joint_driven(closed, rates, np.zeros(3)), weightless)

    return _per_unit(lambda unit: (quadratic(v + unit) - quadratic(v - unit)) / 4, closed)


def mass_and_bias(robot: Robot, pose: ArrayLike, velocity: ArrayLike) -> tuple[Array, Array]:
    """Return M in kg m^2 and ``C q' + G`` in N m in one pass; q' is that of the joints."""
    closed = posture(robot, pose)
    # A batch of four: the actual velocity, then unit accelerations without velocity and gravity.
    lead = (4, *(1 for _ in np.shape(closed.d)))
    real = np.eye(1, 4).reshape(lead)
    velocities = real[..., None] * np.asarray(velocity, dtype=np.float64)
    motion = joint_driven(closed, velocities, np.eye(4, 3, k=-1).reshape(*lead, 3))
    torques = _torque(closed, motion, robot, weight=real)
    return np.moveaxis(torques[1:], 0, -1), torques[0]


def potential_energy(robot: Robot, pose: ArrayLike) -> Array:
    """Return the energy in the field of gravity, zero for all mass in the pivot."""
    closed = posture(robot, pose)
    energy: Scalar = 0.0
    for leg, loads in zip(closed.legs, robot.loads, strict=True):
        elbow = (leg.leg.l0 + leg.leg.l1 * leg.cos_beta, leg.leg.l1 * leg.sin_beta)
        links = (
            (loads[0], (leg.leg.l0, 0.0), (leg.cos_beta, leg.sin_beta)),
            (loads[1], elbow, (leg.cos_kappa, leg.sin_kappa)),
            (loads[2], leg.end, (-leg.sin_gamma, leg.cos_gamma)),
        )
        fall = _gravity_in_plane(robot.gravity_vector, closed, leg)
        energy = energy - sum(dot(fall, first_moment(*link)) for link in links)
    return np.asarray(energy, dtype=np.float64)


def _per_unit(torque: Callable[[Array], Array], closed: Posture) -> Array:
    """Make a matrix of the torques of unit vectors, all in one pass over a leading axis."""
    units = np.eye(3).reshape(3, *(1 for _ in np.shape(closed.d)), 3)
    return np.moveaxis(torque(units), 0, -1)


def _gravity_in_plane(gravity: Vector, closed: Posture, leg: LegPosture) -> Vector:
    """Gravity in the frame a, b, k of a leg's plane."""
    axial = dot(gravity, leg.leg.axis)
    transverse = (dot(gravity, closed.W) - leg.cos_gamma * axial) / leg.sin_gamma
    return axial, transverse, dot(gravity, leg.normal)


def _torque(closed: Posture, motion: RobotMotion, robot: Robot, weight: Scalar = 1.0) -> Array:
    """Collect what every leg takes, with gravity times a weight, and hand it on to the joints."""
    force_W: Vector = (0.0, 0.0, 0.0)
    force_d: Scalar = 0.0
    for leg, rates, loads in zip(closed.legs, motion.legs, robot.loads, strict=True):
        fall = scale(weight, _gravity_in_plane(robot.gravity_vector, closed, leg))
        force_alpha, force_gamma, force_depth = _leg_forces(motion, leg, rates, loads, fall)
        pull = add(scale(force_alpha, leg.normal), scale(-force_gamma, leg.leg.axis))
        force_W = add(force_W, scale(1.0 / leg.sin_gamma, pull))
        force_d = force_d + force_depth
    left, right, middle = closed.legs
    theta3 = force_d / middle.beta_d
    # At constant depth, a rotation of a side leg also moves the crank of the middle leg.
    force_W = add(force_W, scale(theta3 * middle.beta_gamma / middle.sin_gamma, middle.leg.axis))
    theta1 = left.sin_gamma * dot(closed.u1, force_W)
    theta2 = right.sin_gamma * dot(closed.u2, force_W)
    return np.asarray(stack((theta1, theta2, theta3)), dtype=np.float64)


def _leg_forces(
    motion: RobotMotion,
    leg: LegPosture,
    rates: LegMotion,
    loads: tuple[Body, Body, Body],
    fall: Vector,
) -> tuple[Scalar, Scalar, Scalar]:
    """Generalized forces on alpha, gamma and d that one leg takes."""
    plane = Plane(rates.alpha_1, rates.alpha_2, fall)
    l1 = leg.leg.l1
    crank = Direction(leg.cos_beta, leg.sin_beta, rates.beta_1, rates.beta_2)
    coupler = Direction(leg.cos_kappa, leg.sin_kappa, rates.kappa_1, rates.kappa_2)
    # The arm points from the coupler's end to the endoscope, at a right angle to it.
    arm = Direction(-leg.sin_gamma, leg.cos_gamma, rates.gamma_1, rates.gamma_2)
    first = link_forces(loads[0], crank, FIXED, plane)
    second = link_forces(loads[1], coupler, _elbow(l1, crank), plane)
    third = link_forces(loads[2], arm, _coupler_end(motion, leg, rates), plane)
    force_beta = first.angle + l1 * (crank.cos * second.v - crank.sin * second.u)
    force_kappa = second.angle
    force_gamma = third.angle + leg.end_gamma[0] * third.u + leg.end_gamma[1] * third.v
    force_depth = leg.cos_gamma * third.u + leg.sin_gamma * third.v
    return (
        first.alpha + second.alpha + third.alpha + leg.leg.axis_inertia * rates.alpha_2,
        force_gamma + leg.beta_gamma * force_beta + leg.kappa_gamma * force_kappa,
        force_depth + leg.beta_d * force_beta + leg.kappa_d * force_kappa,
    )


def _elbow(l1: float, crank: Direction) -> PlanePoint:
    square = crank.rate * crank.rate
    return PlanePoint(
        v=l1 * crank.sin,
        v_1=l1 * crank.rate * crank.cos,
        u_2=-l1 * (crank.rate_2 * crank.sin + square * crank.cos),
        v_2=l1 * (crank.rate_2 * crank.cos - square * crank.sin),
    )


def _coupler_end(motion: RobotMotion, leg: LegPosture, rates: LegMotion) -> PlanePoint:
    u, v = leg.end
    square, coriolis = rates.gamma_1 * rates.gamma_1, 2 * rates.gamma_1 * motion.d_1
    return PlanePoint(
        v=v,
        v_1=leg.end_gamma[1] * rates.gamma_1 + leg.sin_gamma * motion.d_1,
        u_2=leg.end_gamma[0] * rates.gamma_2
        + leg.cos_gamma * motion.d_2
        - u * square
        - coriolis * leg.sin_gamma,
        v_2=leg.end_gamma[1] * rates.gamma_2
        + leg.sin_gamma * motion.d_2
        - v * square
        + coriolis * leg.cos_gamma,
    )


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
    def means(self) -> tuple[float, ...]:
        """Mean over poses and joints of gravity, Coriolis and inertia."""
        return tuple(float(part.mean()) for part in (self.gravity, self.coriolis, self.inertia))


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
