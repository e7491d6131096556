"""``nrs-design robot dynamics``: matrices and torques at a pose, or the shares of the torque."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.robot.cli.options import (
    Acceleration,
    Pose,
    Three,
    Tilt,
    Velocity,
    print_quantities,
    read_pose,
    three_numbers,
)

if TYPE_CHECKING:
    from nrs_design.robot.models.robot import Robot

_LABELS = {
    "pose": "pose phi, psi, d [rad, rad, m]",
    "velocity": "joint velocities [rad/s]",
    "acceleration": "joint accelerations [rad/s^2]",
    "M": "M [kg m^2]",
    "C": "C [N m s/rad]",
    "G": "G [N m]",
    "Ms": "Ms [kg m^2]",
    "Gs": "Gs [N m]",
    "torque": "joint torques [N m]",
    "shares_by_joint": "share of the torque of each joint [1]",
    "base_tilt": "tilt of the base [rad]",
    "mean_shares": "mean share of the torque [1]",
}


@command("robot-dynamics")
def dynamics(
    spec: SpecFile,
    pose: Pose = None,
    velocity: Velocity = None,
    acceleration: Acceleration = None,
    tilt: Tilt = None,
) -> Answer:
    """Print M, G, Ms and Gs at a pose, and the torques of a motion; or the torque's shares.

    Example: nrs-design robot dynamics specs/robots/neuroboscope.nrs.yaml --pose 0,0,0.2 --json
    """
    import math

    from nrs_design.robot.pipeline import run_robot

    loaded, _, robot = run_robot(spec)
    if tilt is not None:
        robot = robot.tilted(math.radians(tilt))
    if pose is None and (velocity or acceleration):
        raise typer.BadParameter("a motion needs its --pose")
    content: dict[str, Any] = {"base_tilt": robot.base_tilt}
    if pose is None:
        content |= _shares(robot)
    else:
        motion = (velocity or "0,0,0", "--velocity"), (acceleration or "0,0,0", "--acceleration")
        content |= _solve_pose(robot, read_pose(pose, robot), *(three_numbers(*m) for m in motion))
    facts = loaded.facts | content
    return Answer(lambda: facts, lambda: print_quantities(content, _LABELS))


def _solve_pose(robot: Robot, pose: Three, velocity: Three, acceleration: Three) -> dict[str, Any]:
    from nrs_design.robot.models import dynamics as full
    from nrs_design.robot.models.correction import simplified_dynamics

    simplified = simplified_dynamics(robot, pose)
    return {
        "pose": list(pose),
        "velocity": list(velocity),
        "acceleration": list(acceleration),
        "M": full.mass_matrix(robot, pose).tolist(),
        "C": full.coriolis_matrix(robot, pose, velocity).tolist(),
        "G": full.gravity_torque(robot, pose).tolist(),
        "Ms": simplified.Ms.tolist(),
        "Gs": simplified.Gs.tolist(),
        "torque": full.inverse_dynamics(robot, pose, velocity, acceleration).tolist(),
        "units": {"M": "kg*m^2", "C": "N*m*s/rad", "G": "N*m", "torque": "N*m", "pose": "rad, m"},
    }


def _shares(robot: Robot) -> dict[str, Any]:
    from nrs_design.robot.models.dynamics import torque_shares
    from nrs_design.robot.models.workspace import reachable_poses, thesis_grid

    shares = torque_shares(robot, reachable_poses(robot, thesis_grid()))
    parts = asdict(shares)
    return {
        "mean_shares": dict(zip(parts, shares.means, strict=True)),
        "shares_by_joint": {name: part.mean(axis=0).tolist() for name, part in parts.items()},
    }
