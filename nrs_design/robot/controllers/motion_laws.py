"""One tick of the laws of thesis 4.2 to 4.4: computed torque, and a PD on each joint."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.robot.models.dynamics import mass_and_bias
from nrs_design.robot.models.kinematics import JointMotion, direct_kinematics
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.simplified import simplified_dynamics
from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class LoadTerms:
    """Terms that hold where the encoders stand."""

    angle: Array  # The encoders, shape (n, 3), in rad
    inertia: Array  # Shape (n, 3, 3), in kg m^2
    gravity: Array  # Shape (n, 3), in N m


@dataclass(frozen=True, slots=True)
class LoadModel:
    """Simplified dynamics with correction coefficients, ``K Ms`` and ``K Gs`` (thesis 4.17)."""

    robot: Robot  # On its base
    encoder_ratio: float  # Turns of the encoder per turn of the joint
    # K of the three joints (thesis 3.38). None takes the full dynamics M and G instead, which are
    # too much for the robot's processor: to see what the simplification costs.
    correction: tuple[float, float, float] | None

    def terms(self, angle: Array) -> LoadTerms:
        """Compute inertia and weight at encoder angles of shape (n, 3), in rad."""
        pose = direct_kinematics(self.robot, angle / self.encoder_ratio)
        if self.correction is None:
            return LoadTerms(angle, *mass_and_bias(self.robot, pose, np.zeros_like(pose)))
        K = np.array(self.correction)
        simplified = simplified_dynamics(self.robot, pose)
        return LoadTerms(angle, K[:, None] * simplified.Ms, K * simplified.Gs)

    def follow(self, angle: Array, known: LoadTerms | None) -> LoadTerms:
        """Return the terms at encoder angles, computing them only where an encoder has moved."""
        if known is None:
            return self.terms(angle)
        moved = np.any(angle != known.angle, axis=-1)
        if not moved.any():
            return known
        fresh = self.terms(angle[moved])
        inertia, gravity = known.inertia.copy(), known.gravity.copy()
        inertia[moved], gravity[moved] = fresh.inertia, fresh.gravity
        return LoadTerms(angle, inertia, gravity)


@dataclass(frozen=True, slots=True)
class LawState:
    """Memory of a law; empty before its first tick."""

    # Tracking error of the last tick in encoder coordinates, shape (n, 3), in rad.
    error: Array | None = None
    load: LoadTerms | None = None  # The model at the last tick

    def error_rate(self, error: Array, period: float) -> Array:
        """Return the backward difference of the error in rad/s; zero at the first tick."""
        return error * 0.0 if self.error is None else (error - self.error) / period


@dataclass(frozen=True, slots=True)
class ComputedTorque:
    """Torque for a wanted acceleration, as a command (thesis 4.16 to 4.18, corrected).

    ``a = theta_des'' + Kd e' + Kp e`` and ``delta = gradient (K_corr Ms a/(N n) + K_corr Gs/N)``,
    with e and a in encoder coordinates, n turns of the encoder and N of the motor per turn of the
    joint. The acceleration in 4.16 is that of the reference.

    The law of the thesis knows the robot and not its motors. Their inertia and damping, as seen
    from the joints, can be added, to see what that costs; both are 0 in the thesis.
    """

    # Kp, Kd: in 1/s^2 and 1/s (thesis 4.15).
    Kp: float
    Kd: float
    period: float  # Time between two ticks in s
    encoder_ratio: float  # Turns n of the encoder per turn of the joint
    command_per_torque: float  # Command that holds a joint torque, ``gradient/N`` in rpm/(N m)
    load: LoadModel  # Inertia and weight
    rotor_inertia: float = 0.0  # Of a motor at its joint, in kg m^2
    motor_damping: float = 0.0  # Torque per speed of the reference, at the joint, in N m s/rad

    def step(self, state: LawState, reference: JointMotion, angle: Array) -> tuple[Array, LawState]:
        """Compute the commands of one tick in rpm, shape (n, 3), and what the next tick needs.

        Encoder angles are in rad, shape (n, 3); the first state is `LawState()`.
        """
        error = self.encoder_ratio * reference.position - angle
        feedback = self.Kp * error + self.Kd * state.error_rate(error, self.period)
        wanted = reference.acceleration + feedback / self.encoder_ratio
        load = self.load.follow(angle, state.load)
        torque = (load.inertia @ wanted[..., None])[..., 0] + load.gravity
        torque = torque + self.rotor_inertia * wanted + self.motor_damping * reference.velocity
        return self.command_per_torque * torque, LawState(error, load)


@dataclass(frozen=True, slots=True)
class IndependentJoint:
    """PD on each joint (thesis 4.3), with or without its weight fed forward.

    ``delta = Kp e + Kd e' + (gradient/N) K_corr Gs``, the error e in encoder coordinates. The
    thesis prints 4.32 and 4.36 with the speed-torque gradient before all three terms; the PD of
    4.30 is designed from encoder angle to command, so that it is in rpm already.
    """

    # Gains in rpm/rad and rpm s/rad, as on the robot in single precision.
    motion: ProportionalDerivative
    period: float  # Time between two ticks in s
    encoder_ratio: float  # Turns of the encoder per turn of the joint
    command_per_torque: float  # Command that holds a joint torque, ``gradient/N`` in rpm/(N m)
    # Where the weight comes from. None feeds nothing forward, for the balanced robot (4.36).
    load: LoadModel | None

    def step(self, state: LawState, reference: JointMotion, angle: Array) -> tuple[Array, LawState]:
        """Compute the commands of one tick in rpm, shape (n, 3), and what the next tick needs.

        Encoder angles are in rad, shape (n, 3); the first state is `LawState()`.
        """
        error = self.encoder_ratio * reference.position - angle
        rate = state.error_rate(error, self.period)
        command = float(self.motion.Kp) * error + float(self.motion.Kd) * rate
        if self.load is None:
            return command, LawState(error)
        load = self.load.follow(angle, state.load)
        return command + self.command_per_torque * load.gravity, LawState(error, load)


MotionLaw = ComputedTorque | IndependentJoint
