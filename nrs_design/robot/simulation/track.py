"""Tracks: a controller, its mechanism and its experiment."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

import numpy as np

from nrs_design.robot.design.motion_control import (
    AbstractMotionLaw,
    design_computed_torque,
    design_independent_joint,
    design_load_model,
)
from nrs_design.robot.models.balance import balanced_robot, design_balance
from nrs_design.robot.models.drive import JointDrive, build_drive
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.simulation.experiment import Experiment, thesis_experiments
from nrs_design.robot.simulation.plant import Mechanism
from nrs_design.spec import RobotSpec

CONTROLLERS = ("computed-torque", "independent-joint", "balanced")


@dataclass(frozen=True, slots=True)
class Encoder:
    """Absolute encoder at the output of the gearhead (MagAlpha MA707, thesis 4.1)."""

    ratio: float  # Rotations of the encoder per rotation of the joint
    counts: int | None  # Counts per rotation of the encoder; None for exact readings

    def read(self, joints: Array) -> Array:
        """Return the encoder angles in rad for joint angles, rounded to the count."""
        angle = self.ratio * joints
        if self.counts is None:
            return angle
        count = 2 * pi / self.counts
        return np.asarray(count * np.round(angle / count))


@dataclass(frozen=True)
class Track:
    """A controller on a robot, and the experiment that it does."""

    controller: str  # Name for people
    law: AbstractMotionLaw  # The controller
    mechanism: Mechanism  # Moved mechanism
    drive: JointDrive  # Behind each joint
    encoder: Encoder  # On each drive
    experiment: Experiment  # Reference motion


def experiment_tilt(spec: RobotSpec) -> float:
    """Return the tilt of the base for the experiments, in rad.

    It is that of the balance, -28.5 deg in thesis 4.2 and 4.4, or that of the spec without one.
    """
    return spec.base_tilt.si if spec.balance is None else spec.balance.tilt.si


def build_tracks(
    spec: RobotSpec, robot: Robot, controller: str, period: float | None = None
) -> list[Track]:
    """Design one of the thesis's controllers and set up its three experiments.

    A period in s takes the place of those of all sines of the thesis.
    """
    mechanism, law = _mechanism_and_law(spec, robot, controller)
    drive = build_drive(spec.drive)
    encoder = Encoder(drive.encoder_ratio, spec.drive.encoder_counts)
    experiments = thesis_experiments(robot, controller, period)
    return [Track(controller, law, mechanism, drive, encoder, one) for one in experiments]


def _mechanism_and_law(
    spec: RobotSpec, robot: Robot, controller: str
) -> tuple[Mechanism, AbstractMotionLaw]:
    if controller == "balanced":
        balance = design_balance(spec, robot)
        mechanism = Mechanism(balanced_robot(robot, balance), balance)
        return mechanism, design_independent_joint(spec, None)
    load = design_load_model(spec, robot)
    if controller == "computed-torque":
        return Mechanism(robot), design_computed_torque(spec, load)
    return Mechanism(robot), design_independent_joint(spec, load)
