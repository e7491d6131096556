"""The laws of a robot's motion control with the gains that ship, as operations."""

from __future__ import annotations

import numpy as np

from nrs_design.controllers.float32 import float32_not_above
from nrs_design.controllers.operations import StepLaw
from nrs_design.errors import DesignError
from nrs_design.robot.controllers.step_laws import (
    Joints,
    build_base,
    build_computed_torque,
    build_independent_joint,
    build_inverse_dynamics,
)
from nrs_design.robot.controllers.traced_robot import LARGEST_ANGLES
from nrs_design.robot.design.motion_control import (
    design_computed_torque,
    design_independent_joint,
    design_load_model,
)
from nrs_design.robot.models import (
    Robot,
    inverse_kinematics,
    reachable_poses,
    thesis_tilts,
    tilt_table,
    workspace_grid,
)
from nrs_design.robot.models.drive import build_drive
from nrs_design.spec import RobotSpec

# Angles and depths of the workspace at which joint angles are looked at.
GRID = (11, 5)


def design_robot_laws(spec: RobotSpec, robot: Robot) -> dict[str, StepLaw]:
    """Return the laws by the end of their names in C.

    Parameters
    ----------
    spec : RobotSpec
        With `control`.
    robot : Robot
        Built from it.

    Raises
    ------
    DesignError
        If the spec lacks something, its numbers contradict each other, or its workspace has joint
        angles that the laws do not take.
    PoseError
        If the robot does not reach the motions that the table of corrections is made for.
    """
    _check_angles(robot)
    load = design_load_model(spec, robot)
    command = spec.drive.largest_command
    joints = Joints(
        robot,
        build_drive(spec.drive).encoder_ratio,
        None if command is None else float32_not_above(command.not_above),
    )
    return {
        "base": build_base(joints, tilt_table(robot, thesis_tilts())),
        "pd": build_independent_joint(joints, design_independent_joint(spec, None)),
        "pd_gravity": build_independent_joint(joints, design_independent_joint(spec, load)),
        "computed_torque": build_computed_torque(joints, design_computed_torque(spec, load)),
        "inverse_dynamics": build_inverse_dynamics(joints),
    }


def _check_angles(robot: Robot) -> None:
    """Refuse a robot whose joints turn further in its workspace than the laws' formulas hold."""
    poses = reachable_poses(robot, workspace_grid(robot, *GRID))
    reached = np.abs(inverse_kinematics(robot, poses)).max(axis=0).tolist()
    for joint, (angle, most) in enumerate(zip(reached, LARGEST_ANGLES, strict=True), 1):
        if angle > most:
            raise DesignError(
                f"theta{joint} turns to {angle:.3g} rad within the workspace, and the program "
                f"takes {most:g} rad at most",
                remedy="narrow the workspace",
                at=("workspace",),
            )
