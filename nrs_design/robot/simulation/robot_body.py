"""All links of a robot between its drives: what the commands of three axes move.

``(J I + M(q)) q'' + J/tau q' + C q' + G = J Km/tau u - F``, with the inertia J of a drive at its
joint, and with the torque F of what each axis touches; G is what gravity compensation leaves. An
axis counts its angle from the pose of rest. The links are those of `robot track`, and so are the
steps, which let dry friction stick.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.models.plant import Plant
from nrs_design.robot.models import Robot, gravity_torque, inverse_kinematics
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.simulation.tracking import DriveArrays, JointState, Mechanism, Stepper
from nrs_design.simulation.sampled_axis import PARTS, SampledAxis

# No robot moves so fast, in rad/s.
FASTEST = 1e4


@dataclass(frozen=True, slots=True)
class Arm:
    """A robot that stands in a pose, and what its drives do about gravity."""

    robot: Robot  # All of its links
    rest: Array  # Shape (3,). The pose (phi, psi, d) in which it begins, in rad and m.
    holds: bool = False  # Whether gravity is compensated in that pose alone; else in every pose

    @property
    def joints(self) -> Array:
        """Joint angles of the pose of rest, shape (3,), in rad.

        Raises
        ------
        PoseError
            If the robot cannot reach it.
        """
        return inverse_kinematics(self.robot, self.rest)

    @property
    def weighing(self) -> Robot:
        """The robot with the gravity that is not compensated everywhere."""
        return self.robot if self.holds else replace(self.robot, gravity=0.0)

    @property
    def held(self) -> Array:
        """Constant joint torques that compensate gravity in the pose of rest, shape (3,), N m."""
        return gravity_torque(self.weighing, self.rest)


def drive_torques(plant: Plant) -> tuple[float, float, float]:
    """Return inertia, damping and torque per command of a drive at its joint.

    Parameters
    ----------
    plant : Plant
        With a load inertia J in kg m^2: the motor ``tau omega' = Km u - omega`` is
        ``J omega' = J Km/tau u - J/tau omega``.

    Returns
    -------
    tuple of float
        In kg m^2, N m s/rad, and N m per unit of the commands.
    """
    J = 1.0 if plant.load_inertia is None else float(plant.load_inertia)
    tau = float(plant.actuator.time_constant)
    return J, J / tau, J * float(plant.actuator.gain) / tau


class RobotBody:
    """The robot's full dynamics, integrated by steps of `nrs_design.robot.simulation.tracking`.

    Mass matrices, Coriolis torques and gravity hold for one sample of the law; tissue pushes anew
    at every part of it.

    Parameters
    ----------
    arm : Arm
        The robot.
    plant : Plant
        The drives.
    axes : sequence of SampledAxis
        At rest, theta1 to theta3.

    Raises
    ------
    PoseError
        If the robot cannot reach the pose of rest.
    """

    def __init__(self, arm: Arm, plant: Plant, axes: Sequence[SampledAxis]) -> None:
        inertia, damping, torque = drive_torques(plant)
        friction = [torque * axis.scenario.errors.friction for axis in axes]
        one = np.ones((1, 1))
        self.drives = DriveArrays(inertia * one, damping * one, torque * one, np.array([friction]))
        self.mechanism, self.rest, self.held = Mechanism(arm.weighing), arm.joints, arm.held
        self.state = JointState(self.rest[None, :], np.zeros((1, 3)), np.zeros((1, 3)))

    def move(self, axes: Sequence[SampledAxis], commands: Sequence[float], width: float) -> None:
        """Move all joints at once; see `nrs_design.simulation.processor.AbstractBody`.

        Parameters
        ----------
        axes, commands, width
            As there.

        Raises
        ------
        PoseError
            If the robot cannot reach where they would go.
        """
        state, part, command = self.state, width / PARTS, np.array([commands])
        mass, bias = self.mechanism.mass_and_bias(state.position, state.velocity)
        stepper = Stepper.at(self.drives, part, mass, bias - self.held)
        for _ in range(PARTS):
            push = np.array([[axis.tissue.torque(axis.theta, axis.omega) for axis in axes]])
            state = replace(stepper, bias=stepper.bias + push).step(state, command)
            if not np.abs(state.velocity).max() < FASTEST:
                raise runs_away()
            place(axes, state.position[0] - self.rest, state.velocity[0], part)
        self.state = state


def place(axes: Sequence[SampledAxis], angles: Array, velocities: Array, time: float) -> None:
    """Put all axes where they have come to, and let the dampers of their tissue follow.

    Parameters
    ----------
    axes : sequence of SampledAxis
        Where they were.
    angles, velocities : ndarray
        In rad and rad/s, one for each axis.
    time : float
        That it took, in s.
    """
    for axis, angle, velocity in zip(axes, angles.tolist(), velocities.tolist(), strict=True):
        before = axis.tissue.depths(axis.theta)
        axis.theta, axis.omega = angle, velocity
        axis.tissue.creep(before, axis.tissue.depths(angle), time)


def runs_away() -> DesignError:
    """Return the error of a body that nothing holds any more."""
    return DesignError(
        "the simulated mechanism moves beyond all bounds",
        remedy="check the gains and the sample period: the loop may be unstable",
    )
