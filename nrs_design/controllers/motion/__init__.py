"""Motion control of the robot's joints (thesis 4.2 to 4.4): one tick of each law."""

from nrs_design.controllers.motion.computed_torque import ComputedTorque
from nrs_design.controllers.motion.independent_joint import IndependentJoint
from nrs_design.controllers.motion.load_model import LoadModel, LoadTerms
from nrs_design.controllers.motion.reference import JointReference
from nrs_design.controllers.motion.state import LawState

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
