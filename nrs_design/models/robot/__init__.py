"""The robot: geometry, kinematics, dynamics, simplified dynamics and balance (thesis 3 and 4)."""

from nrs_design.models.robot.dynamics import (
    coriolis_matrix,
    gravity_torque,
    inverse_dynamics,
    mass_matrix,
)
from nrs_design.models.robot.geometry import is_reachable, posture, reach, reach_margin
from nrs_design.models.robot.kinematics import (
    JointMotion,
    direct_kinematics,
    inverse_jacobian,
    inverse_kinematics,
    jacobian,
    joint_motion,
    orientation,
    orientation_jacobian,
    singularity_margins,
)
from nrs_design.models.robot.robot import Leg, Robot, TaskLimits, Workspace, build_robot

__all__ = [
    "JointMotion",
    "Leg",
    "Robot",
    "TaskLimits",
    "Workspace",
    "build_robot",
    "coriolis_matrix",
    "direct_kinematics",
    "gravity_torque",
    "inverse_dynamics",
    "inverse_jacobian",
    "inverse_kinematics",
    "is_reachable",
    "jacobian",
    "joint_motion",
    "mass_matrix",
    "orientation",
    "orientation_jacobian",
    "posture",
    "reach",
    "reach_margin",
    "singularity_margins",
]
