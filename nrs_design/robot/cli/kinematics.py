"""``nrs-design robot kinematics``: joints of a pose, Jacobians, or the whole workspace."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.robot.cli.options import Pose, lists, print_quantities, read_pose, three_numbers

if TYPE_CHECKING:
    from nrs_design.robot.models.robot import Robot

_LABELS = {
    "pose": "pose phi, psi, d [rad, rad, m]",
    "inverse_jacobian": "inverse Jacobian",
    "theta_xy_d": "orientation theta_x, theta_y, d [rad, rad, m]",
    "joints": "joint angles theta1, theta2, theta3 [rad]",
    "jacobian": "Jacobian",
    "joint_low": "lowest joint angles [rad]",
    "joint_high": "highest joint angles [rad]",
    "largest_joint_velocity": "largest joint velocities [rad/s]",
    "largest_joint_acceleration": "largest joint accelerations [rad/s^2]",
    "reach_margin": "reach margin of left, right, middle leg [m]",
    "coupler_margin": "coupler margin of left, right, middle leg [1]",
    "reachable_share": "reachable share of the workspace [1]",
}


@command("robot-kinematics")
def kinematics(
    spec: SpecFile,
    pose: Pose = None,
    joints: Annotated[
        str | None,
        typer.Option("--joints", metavar="T1,T2,T3", help="Joint angles in rad, for their pose."),
    ] = None,
) -> Answer:
    """Solve the kinematics at a pose or joint angles, or survey the workspace.

    Example: nrs-design robot kinematics specs/robots/neuroboscope.nrs.yaml --pose 0.1,-0.2,0.2
    """
    from nrs_design.robot.models.kinematics import direct_kinematics
    from nrs_design.robot.pipeline import run_robot

    loaded, _, robot = run_robot(spec)
    if pose is not None and joints is not None:
        raise typer.BadParameter("give --pose or --joints, not both")
    if joints is not None:
        found = direct_kinematics(robot, three_numbers(joints, "--joints"))
        content = _solve_pose(robot, tuple(map(float, found)))
    elif pose is not None:
        content = _solve_pose(robot, read_pose(pose, robot))
    else:
        content = _workspace(robot)
    facts = loaded.facts | content
    return Answer(lambda: facts, lambda: print_quantities(content, _LABELS))


def _solve_pose(robot: Robot, pose: tuple[float, ...]) -> dict[str, Any]:
    from nrs_design.robot.models.geometry import reach_margin
    from nrs_design.robot.models.kinematics import (
        coupler_margin,
        inverse_jacobian,
        inverse_kinematics,
        jacobian,
        orientation,
    )

    return {
        "pose": list(pose),
        "joints": inverse_kinematics(robot, pose).tolist(),
        "theta_xy_d": orientation(pose).tolist(),
        "jacobian": jacobian(robot, pose).tolist(),
        "inverse_jacobian": inverse_jacobian(robot, pose).tolist(),
        "reach_margin": reach_margin(robot, pose).tolist(),
        "coupler_margin": coupler_margin(robot, pose).tolist(),
        "units": {"angles": "rad", "lengths": "m", "coupler_margin": "1"},
    }


def _workspace(robot: Robot) -> dict[str, Any]:
    from nrs_design.robot.models.workspace import joint_peaks, survey_workspace, workspace_grid

    survey = survey_workspace(robot)
    velocity, acceleration = joint_peaks(robot, workspace_grid(robot))
    return {
        "reachable_share": survey.reachable,
        **lists(survey, "joint_low", "joint_high", "reach_margin", "coupler_margin"),
        "largest_joint_velocity": velocity.tolist(),
        "largest_joint_acceleration": acceleration.tolist(),
        "units": {"angles": "rad", "lengths": "m", "velocity": "rad/s", "acceleration": "rad/s^2"},
    }
