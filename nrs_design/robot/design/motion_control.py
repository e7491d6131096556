"""Motion control of the joints (thesis 4.2 to 4.4): one tick of the laws, and their gains."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws import ProportionalDerivative
from nrs_design.design.root_locus import PdDesign, design_pd
from nrs_design.errors import DesignError
from nrs_design.robot.models.correction import (
    DEPTH_SINES,
    correction_coefficients,
    simplified_dynamics,
)
from nrs_design.robot.models.drive import build_drive
from nrs_design.robot.models.kinematics import JointMotion, direct_kinematics
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array
from nrs_design.spec import RobotSpec
from nrs_design.spec.robot import RobotControlSpec


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
    encoder_ratio: float  # Rotations of the encoder per rotation of the joint
    correction: tuple[float, float, float]  # K of the three joints (thesis 3.38)

    def terms(self, angle: Array) -> LoadTerms:
        """Compute inertia and weight at encoder angles of shape (n, 3), in rad."""
        pose = direct_kinematics(self.robot, angle / self.encoder_ratio)
        K = np.array(self.correction)
        simplified = simplified_dynamics(self.robot, pose)
        return LoadTerms(angle, K[:, None] * simplified.Ms, K * simplified.Gs)

    def follow(self, angle: Array, previous: LoadTerms | None) -> LoadTerms:
        """Return the terms at encoder angles, computing them only where an encoder has moved."""
        if previous is None:
            return self.terms(angle)
        is_changed = np.any(angle != previous.angle, axis=-1)
        if not is_changed.any():
            return previous
        fresh = self.terms(angle[is_changed])
        inertia, gravity = previous.inertia.copy(), previous.gravity.copy()
        inertia[is_changed], gravity[is_changed] = fresh.inertia, fresh.gravity
        return LoadTerms(angle, inertia, gravity)


@dataclass(frozen=True, slots=True)
class LawState:
    """Memory of a law; empty before its first tick."""

    # Tracking error of the last tick in encoder coordinates, shape (n, 3), in rad.
    error: Array | None = None
    load: LoadTerms | None = None  # The model at the last tick


@dataclass(frozen=True, kw_only=True)
class AbstractMotionLaw(ABC):
    """A law that follows joint angles by their encoders."""

    period: float  # Time between two ticks in s
    encoder_ratio: float  # Rotations n of the encoder per rotation of the joint
    command_per_torque: float  # Command that holds a joint torque, ``gradient/N`` in rpm/(N m)

    @abstractmethod
    def step(self, state: LawState, reference: JointMotion, angle: Array) -> tuple[Array, LawState]:
        """Return the commands of one tick in rpm, shape (n, 3), and what the next tick needs.

        Encoder angles are in rad, shape (n, 3); the first state is `LawState()`.
        """

    def errors(self, state: LawState, reference: JointMotion, angle: Array) -> tuple[Array, Array]:
        """Return the error in encoder coordinates in rad, and its rate in rad/s."""
        error = self.encoder_ratio * reference.position - angle
        # A backward difference; zero at the first tick.
        return error, error * 0.0 if state.error is None else (error - state.error) / self.period


@dataclass(frozen=True, kw_only=True)
class ComputedTorque(AbstractMotionLaw):
    """Torque for a wanted acceleration, as a command (thesis 4.16 to 4.18, corrected).

    ``a = theta_des'' + Kd e' + Kp e`` and ``delta = gradient (K_corr Ms a/(N n) + K_corr Gs/N)``,
    with e and a in encoder coordinates, n turns of the encoder and N of the motor per turn of the
    joint. The acceleration in 4.16 is that of the reference. The law of the thesis knows the robot
    and not its motors.
    """

    Kp: float  # In 1/s^2 (thesis 4.15)
    Kd: float  # In 1/s
    load: LoadModel  # Inertia and weight

    def step(self, state: LawState, reference: JointMotion, angle: Array) -> tuple[Array, LawState]:
        """Return the commands and the next state."""
        error, rate = self.errors(state, reference, angle)
        demand = reference.acceleration + (self.Kp * error + self.Kd * rate) / self.encoder_ratio
        load = self.load.follow(angle, state.load)
        torque = (load.inertia @ demand[..., None])[..., 0] + load.gravity
        return self.command_per_torque * torque, LawState(error, load)


@dataclass(frozen=True, kw_only=True)
class IndependentJoint(AbstractMotionLaw):
    """PD on each joint (thesis 4.3), with or without its weight fed forward.

    ``delta = Kp e + Kd e' + (gradient/N) K_corr Gs``, the error e in encoder coordinates. The
    thesis prints 4.32 and 4.36 with the speed-torque gradient before all three terms; the PD of
    4.30 is designed from encoder angle to command, so that it is in rpm already.
    """

    # Gains in rpm/rad and rpm s/rad, as on the robot in single precision.
    motion: ProportionalDerivative
    # Source of the weight; None without feedforward, for the balanced robot (4.36).
    load: LoadModel | None

    def step(self, state: LawState, reference: JointMotion, angle: Array) -> tuple[Array, LawState]:
        """Return the commands and the next state."""
        error, rate = self.errors(state, reference, angle)
        command = float(self.motion.Kp) * error + float(self.motion.Kd) * rate
        if self.load is None:
            return command, LawState(error)
        load = self.load.follow(angle, state.load)
        return command + self.command_per_torque * load.gravity, LawState(error, load)


def control_of(spec: RobotSpec) -> RobotControlSpec:
    """Return what a robot spec says about its motion control; nothing said is a `DesignError`."""
    if spec.control is None:
        raise DesignError("this robot spec has no `control`", remedy="add it, as `init robot` does")
    if spec.control.motion_loop.transfer_function is not None:
        raise DesignError(
            "motion control needs a controller, not a closed loop",
            remedy="take transfer_function out of control.motion_loop",
        )
    return spec.control


def design_load_model(spec: RobotSpec, robot: Robot) -> LoadModel:
    """Return the simplified dynamics with the correction coefficients for the robot's tilt.

    These are mean ratios over slow motions of the depth, as thesis 4.19 takes them from fig. 3.12.
    """
    first, second, third = correction_coefficients(robot, DEPTH_SINES).mean_ratio.tolist()
    return LoadModel(robot, build_drive(spec.drive).encoder_ratio, (first, second, third))


def design_computed_torque(spec: RobotSpec, load: LoadModel) -> ComputedTorque:
    """Choose the error dynamics by damping ratio and settling time (thesis 4.14 and 4.15)."""
    wn, zeta = _root_locus(spec).natural_frequency, control_of(spec).motion_loop.damping_ratio
    return ComputedTorque(Kp=wn**2, Kd=2 * float(zeta) * wn, load=load, **_drive_numbers(spec))


def design_independent_joint(spec: RobotSpec, load: LoadModel | None) -> IndependentJoint:
    """Choose the PD by root locus, or take the one that the spec gives (thesis 4.30)."""
    motion = _proportional_derivative(spec)
    return IndependentJoint(motion=motion, load=load, **_drive_numbers(spec))


def _drive_numbers(spec: RobotSpec) -> dict[str, float]:
    """Return sample period and drive constants of both laws."""
    drive = build_drive(spec.drive)
    return {
        "period": control_of(spec).sample_period.si,
        "encoder_ratio": drive.encoder_ratio,
        "command_per_torque": 1 / drive.torque_per_command,
    }


def _proportional_derivative(spec: RobotSpec) -> ProportionalDerivative:
    given, design = control_of(spec).motion_loop, _root_locus(spec)
    Kd = round_float32(
        Fraction(design.derivative_gain)
        if given.derivative_gain is None
        else given.derivative_gain.exact
    )
    zero = Fraction(design.zero) if given.zero is None else given.zero.exact
    return ProportionalDerivative(Kp=round_float32(Kd * zero), Kd=Kd)


def _root_locus(spec: RobotSpec) -> PdDesign:
    loop = control_of(spec).motion_loop
    return design_pd(
        spec.drive.gain.si,
        spec.drive.time_constant.si,
        float(loop.damping_ratio),
        loop.settling_time.si,
    )
