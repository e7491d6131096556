"""The robot: geometry, kinematics, dynamics, simplified dynamics and balance (thesis 3 and 4)."""

from nrs_design.models.robot.balance import (
    Balance,
    balanced_robot,
    design_balance,
    residual_torque,
    spring_torque,
)
from nrs_design.models.robot.correction import (
    Correction,
    Sine,
    TiltTable,
    correction_coefficients,
    thesis_tilts,
    tilt_table,
)
from nrs_design.models.robot.dynamics import (
    coriolis_matrix,
    gravity_torque,
    inverse_dynamics,
    mass_and_bias,
    mass_matrix,
    potential_energy,
)
from nrs_design.models.robot.geometry import is_reachable, posture, reach, reach_margin
from nrs_design.models.robot.kinematics import (
    JointMotion,
    SingularityMargins,
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
from nrs_design.models.robot.shares import TorqueShares, torque_shares
from nrs_design.models.robot.simplified import (
    SimplifiedDynamics,
    simplified_dynamics,
    simplified_torque,
)
from nrs_design.models.robot.workspace import (
    JointPeaks,
    joint_peaks,
    pose_grid,
    thesis_grid,
    workspace_grid,
)

__all__ = [
    "Balance",
    "Correction",
    "JointMotion",
    "JointPeaks",
    "Leg",
    "Robot",
    "SimplifiedDynamics",
    "Sine",
    "SingularityMargins",
    "TaskLimits",
    "TiltTable",
    "TorqueShares",
    "Workspace",
    "balanced_robot",
    "build_robot",
    "coriolis_matrix",
    "correction_coefficients",
    "design_balance",
    "direct_kinematics",
    "gravity_torque",
    "inverse_dynamics",
    "inverse_jacobian",
    "inverse_kinematics",
    "is_reachable",
    "jacobian",
    "joint_motion",
    "joint_peaks",
    "mass_and_bias",
    "mass_matrix",
    "orientation",
    "orientation_jacobian",
    "pose_grid",
    "posture",
    "potential_energy",
    "reach",
    "reach_margin",
    "residual_torque",
    "simplified_dynamics",
    "simplified_torque",
    "singularity_margins",
    "spring_torque",
    "thesis_grid",
    "thesis_tilts",
    "tilt_table",
    "torque_shares",
    "workspace_grid",
]
