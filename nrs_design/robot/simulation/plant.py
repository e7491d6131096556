"""Differential equation of the robot with its drives, and one time step.

``(M + N^2 I_r) q'' + damping q' + C q' + G + springs = torque_per_command delta - friction``: the
full dynamics of all links, with counter-masses and springs where the robot is balanced, and the
rotors behind their gears.

Dry friction really sticks, by velocities at the end of a step (Moreau's time stepping): a joint has
the velocity zero if some friction within its limit stops it within the step. There is no threshold
on the velocity. SciPy integrates no equation with such a jump.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import astuple, dataclass

import numpy as np

from nrs_design.robot.models.balance import Balance, spring_torque
from nrs_design.robot.models.drive import JointDrive
from nrs_design.robot.models.dynamics import mass_and_bias
from nrs_design.robot.models.kinematics import direct_kinematics
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array

# Change of the velocities at which the iteration ends, in rad/s.
ACCURACY = 1e-10
LIMIT = 20_000


def slide_or_stick(inertia: Array, impulse: Array, limit: Array, start: Array) -> Array:
    """Return the velocities v of ``inertia v + p = impulse`` with dry friction p, in rad/s.

    Each ``|p_i| <= limit_i``, and ``p_i = limit_i sign(v_i)`` where v_i is not zero. There is
    exactly one solution, the minimum of ``v' inertia v/2 - v' impulse + sum limit_i |v_i|``. It
    is found by proximal steps in a diagonal metric that dominates the inertia, so that every step
    comes nearer; where the rotors outweigh what couples the joints, a few steps are enough.

    Inertias are symmetric and positive definite, shape (n, 3, 3), in kg m^2; impulse, limit and
    a guess of the velocities have the shape (n, 3).
    """
    metric = np.abs(inertia).sum(axis=-1)
    slack = np.eye(3) * metric[:, :, None] - inertia
    v = start
    for _ in range(LIMIT):
        effort = impulse + _times(slack, v)
        new: Array = (effort - np.minimum(np.maximum(effort, -limit), limit)) / metric
        change = np.abs(new - v).max()
        v = new
        if change <= ACCURACY:
            return v
    raise ArithmeticError("the velocities under dry friction do not converge")


@dataclass(frozen=True, slots=True)
class JointState:
    """Angles, velocities and dry friction of the joints, shape (n, 3), in rad, rad/s and N m."""

    position: Array
    velocity: Array
    friction: Array

    def is_like(self, previous: JointState) -> bool:
        """Tell whether nothing has moved between two states."""
        return bool(
            np.array_equal(self.position, previous.position)
            and np.array_equal(self.velocity, previous.velocity)
        )


@dataclass(frozen=True)
class Mechanism:
    """What the drives move: all links and the platform, and perhaps a balance."""

    robot: Robot  # Robot on its base, with counter-masses if balanced
    balance: Balance | None = None  # The balance whose springs act on it

    def mass_and_bias(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Return the mass matrices in kg m^2, and all torques in N m that no acceleration makes.

        Position and velocity are those of the joints, shape (n, 3), in rad and rad/s.
        """
        pose = direct_kinematics(self.robot, position)
        mass, bias = mass_and_bias(self.robot, pose, velocity)
        if self.balance is None:
            return mass, bias
        return mass, bias + spring_torque(self.robot, self.balance, pose)


def batch_of(drives: Iterable[JointDrive]) -> JointDrive:
    """Return one drive for each robot of a batch as a drive of arrays, shapes (n, 1)."""
    return JointDrive(*np.array([astuple(drive) for drive in drives]).T[..., None])


@dataclass(frozen=True, slots=True)
class Stepper:
    """Steps of a fixed length, with mass matrices and bias that hold for some of them.

    Velocity and damping are those of the middle of the step (the implicit midpoint rule), so that
    kinetic energy, work and losses balance exactly while the matrices hold. The friction follows
    from the velocity at the end of the step.
    """

    drives: JointDrive  # Drives of the batch
    h: float  # Length of a step in s
    mass: Array  # M and the rotors, shape (n, 3, 3)
    bias: Array  # Shape (n, 3), in N m
    inertia: Array  # The same, with half a step of damping: it acts at the end of the step
    inverse: Array  # Its inverse, shape (n, 3, 3)

    @staticmethod
    def create(drives: JointDrive, h: float, mass: Array, bias: Array) -> Stepper:
        """Return the stepper of h seconds for mass matrices and bias (N m) of the mechanism."""
        total = mass + np.eye(3) * drives.inertia[..., None]
        inertia = total + np.eye(3) * (h / 2 * drives.damping)[..., None]
        return Stepper(drives, h, total, bias, inertia, np.asarray(np.linalg.inv(inertia)))

    def step(self, state: JointState, command: Array) -> JointState:
        """Return the state one step later, under commands of shape (n, 3), in rpm."""
        drives, h, v = self.drives, self.h, state.velocity
        drive_impulse = h * (drives.torque_per_command * command - self.bias)
        impulse = _times(self.mass, v) - h / 2 * drives.damping * v + drive_impulse
        # The friction of the last step is right while a joint keeps sliding.
        guess = np.where(v == 0.0, 0.0, _times(self.inverse, impulse - h * state.friction))
        new = slide_or_stick(self.inertia, impulse, h * drives.friction, guess)
        friction = (impulse - _times(self.inertia, new)) / h
        return JointState(state.position + h / 2 * (v + new), new, friction)


def _times(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])
