"""Simulation of motion control against the full dynamics of the robot (thesis 4.2 to 4.4)."""

from nrs_design.robot.simulation.tracking.ablation import ablation_tracks
from nrs_design.robot.simulation.tracking.experiment import (
    COORDINATE,
    MOTIONS,
    Experiment,
    thesis_experiments,
)
from nrs_design.robot.simulation.tracking.friction import DryFriction
from nrs_design.robot.simulation.tracking.plant import DriveArrays, JointState, Mechanism, Stepper
from nrs_design.robot.simulation.tracking.record import TrackingRecord
from nrs_design.robot.simulation.tracking.simulate import LEFT_OUT, simulate
from nrs_design.robot.simulation.tracking.track import (
    CONTROLLERS,
    Encoder,
    Track,
    build_track,
    experiment_tilt,
)

__all__ = [
    "CONTROLLERS",
    "COORDINATE",
    "LEFT_OUT",
    "MOTIONS",
    "DriveArrays",
    "DryFriction",
    "Encoder",
    "Experiment",
    "JointState",
    "Mechanism",
    "Stepper",
    "Track",
    "TrackingRecord",
    "ablation_tracks",
    "build_track",
    "experiment_tilt",
    "simulate",
    "thesis_experiments",
]
