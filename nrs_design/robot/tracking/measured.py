"""Tracking errors that were measured on the robot of the thesis, tables 4.2 to 4.10."""

from __future__ import annotations

from nrs_design.robot.models.robot import Robot, robot, robot_spec
from nrs_design.robot.tracking.experiment import MOTIONS, Experiment, thesis_experiments
from nrs_design.robot.tracking.track import CONTROLLERS, experiment_tilt
from nrs_design.spec import RobotSpec

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
