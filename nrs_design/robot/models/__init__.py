"""The robot: geometry, kinematics, dynamics, simplified dynamics and balance (thesis 3 and 4)."""

from __future__ import annotations

from nrs_design.robot.models.balance import design_balance, examine_balance
from nrs_design.robot.models.correction import (
    DEPTH_SINES,
    TABLE_3_5,
    Correction,
    SeparateCorrection,
    Sine,
    TiltTable,
    correct_separately,
    correction_coefficients,
    thesis_tilts,
    tilt_tables,
    to_csv,
)
from nrs_design.robot.models.dynamics import (
    coriolis_matrix,
    gravity_torque,
    inverse_dynamics,
    mass_matrix,
    torque_shares,
)
from nrs_design.robot.models.geometry import posture
from nrs_design.robot.models.kinematics import (
    direct_kinematics,
    inverse_jacobian,
    inverse_kinematics,
    jacobian,
    orientation,
    singularity_margins,
)
from nrs_design.robot.models.robot import Leg, Robot, build_robot
from nrs_design.robot.models.simplified import simplified_dynamics
from nrs_design.robot.models.workspace import (
    WorkspaceSurvey,
    examine_inertia,
    joint_peaks,
    reachable_poses,
    survey_workspace,
    thesis_grid,
    workspace_grid,
)

__all__ = [
    "DEPTH_SINES",
    "TABLE_3_5",
    "Correction",
    "Leg",
    "Robot",
    "SeparateCorrection",
    "Sine",
    "TiltTable",
    "WorkspaceSurvey",
    "build_robot",
    "coriolis_matrix",
    "correct_separately",
    "correction_coefficients",
    "design_balance",
    "direct_kinematics",
    "examine_balance",
    "examine_inertia",
    "gravity_torque",
    "inverse_dynamics",
    "inverse_jacobian",
    "inverse_kinematics",
    "jacobian",
    "joint_peaks",
    "mass_matrix",
    "orientation",
    "posture",
    "reachable_poses",
    "simplified_dynamics",
    "singularity_margins",
    "survey_workspace",
    "thesis_grid",
    "thesis_tilts",
    "tilt_tables",
    "to_csv",
    "torque_shares",
    "workspace_grid",
]
