"""What runs together: a controller, what it moves, and where to; and what was measured of it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi

import numpy as np

from nrs_design.robot.design.motion_control import (
    MotionLaw,
    design_computed_torque,
    design_independent_joint,
    design_load_model,
)
from nrs_design.robot.models.balance import balanced_robot, design_balance
from nrs_design.robot.models.drive import JointDrive, build_drive
from nrs_design.robot.models.robot import Robot, robot, robot_spec
from nrs_design.robot.models.vectors import Array
from nrs_design.robot.simulation.experiment import MOTIONS, Experiment, thesis_experiments
from nrs_design.robot.simulation.plant import Mechanism
from nrs_design.spec import RobotSpec

CONTROLLERS = ("computed-torque", "independent-joint", "balanced")


@dataclass(frozen=True, slots=True)
class Encoder:
    """Absolute encoder at the output of the gearhead (MagAlpha MA707, thesis 4.1)."""

    ratio: float  # Turns of the encoder per turn of the joint
    counts: int | None  # Per turn of the encoder; None does not round

    def read(self, joints: Array) -> Array:
        """Return what encoders say of joint angles: their own angles in rad, to the count."""
        angle = self.ratio * joints
        if self.counts is None:
            return angle
        count = 2 * pi / self.counts
        return np.asarray(count * np.round(angle / count))


@dataclass(frozen=True)
class Track:
    """A controller on a robot, and the experiments that it does."""

    controller: str  # Name for people
    law: MotionLaw  # The controller
    mechanism: Mechanism  # What it moves
    drive: JointDrive  # Behind each joint
    encoder: Encoder  # On each drive
    experiments: tuple[Experiment, ...]  # What is asked for

    def only(self, moved: str | None) -> Track:
        """Return the track with the experiment that moves one coordinate; None keeps all."""
        kept = tuple(one for one in self.experiments if moved in (None, one.moved))
        return replace(self, experiments=kept)

    def split(self) -> tuple[Track, ...]:
        """Return one track for each experiment."""
        return tuple(replace(self, experiments=(one,)) for one in self.experiments)


def experiment_tilt(spec: RobotSpec) -> float:
    """Return the tilt of the base for the experiments, in rad.

    It is the one that the balance is made for, -28.5 deg in the thesis (4.2 and 4.4), or that of
    the spec if it has no balance.
    """
    return spec.base_tilt.si if spec.balance is None else spec.balance.tilt.si


def build_track(
    spec: RobotSpec, robot: Robot, controller: str, period: float | None = None
) -> Track:
    """Design one of the thesis's controllers and set up its three experiments.

    A period in s takes the place of those of all sines of the thesis.
    """
    mechanism, law = _mechanism_and_law(spec, robot, controller)
    drive = build_drive(spec.drive)
    encoder = Encoder(drive.encoder_ratio, spec.drive.encoder_counts)
    experiments = thesis_experiments(robot, controller, period)
    return Track(controller, law, mechanism, drive, encoder, experiments)


def _mechanism_and_law(
    spec: RobotSpec, robot: Robot, controller: str
) -> tuple[Mechanism, MotionLaw]:
    if controller == "balanced":
        balance = design_balance(spec, robot)
        mechanism = Mechanism(balanced_robot(robot, balance), balance)
        return mechanism, design_independent_joint(spec, None)
    load = design_load_model(spec, robot)
    if controller == "computed-torque":
        return Mechanism(robot), design_computed_torque(spec, load)
    return Mechanism(robot), design_independent_joint(spec, load)


# Controller, tables, and RMSE of phi, psi (deg) and d (mm) where d, phi or psi moves.
MEASURED = (
    (
        "computed torque",
        ("4.2", "4.3", "4.4"),
        ("0.0515, 0.1080, 0.2417", "0.8216, 0.0626, 0.1783", "0.0511, 0.7248, 0.8359"),
    ),
    (
        "independent joints",
        ("4.5", "4.6", "4.7"),
        ("0.0124, 0.0555, 0.5122", "0.0624, 0.0279, 0.1261", "0.0157, 0.0488, 0.2224"),
    ),
    (
        "balanced robot",
        ("4.8", "4.9", "4.10"),
        ("0.0449, 0.0680, 0.6263", "0.2139, 0.0782, 0.5086", "0.0690, 0.2347, 0.5827"),
    ),
)


def measured_rmse(
    spec: RobotSpec, base: Robot, controller: str, experiment: Experiment
) -> tuple[float, float, float] | None:
    """Return what was measured on the robot: errors (RMS) of phi and psi in deg and of d in mm.

    None for another robot, another tilt of the base or another motion than those of the thesis.
    """
    ours = robot_spec()
    same = {"name": ours.name, "title": ours.title, "base_tilt": ours.base_tilt}
    if spec.model_copy(update=same) != ours or base.base_tilt != experiment_tilt(ours):
        return None
    wanted = dict(zip(MOTIONS, thesis_experiments(robot(), controller), strict=True))
    if experiment != wanted[experiment.moved]:
        return None
    prints = MEASURED[CONTROLLERS.index(controller)][2]
    phi, psi, d = map(float, prints[MOTIONS.index(experiment.moved)].split(", "))
    return phi, psi, d
