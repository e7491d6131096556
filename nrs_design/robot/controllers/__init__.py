"""Motion control of the robot's joints (thesis 4.2 to 4.4): one tick of each law."""

from nrs_design.robot.controllers.computed_torque import ComputedTorque
from nrs_design.robot.controllers.independent_joint import IndependentJoint
from nrs_design.robot.controllers.load_model import LoadModel, LoadTerms
from nrs_design.robot.controllers.reference import JointReference
from nrs_design.robot.controllers.state import LawState

MotionLaw = ComputedTorque | IndependentJoint

__all__ = [
    "ComputedTorque",
    "IndependentJoint",
    "JointReference",
    "LawState",
    "LoadModel",
    "LoadTerms",
    "MotionLaw",
]
