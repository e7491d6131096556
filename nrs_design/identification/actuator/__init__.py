"""The velocity-controlled motor from sinusoid records or a frequency response."""

from nrs_design.identification.actuator.identify import (
    ActuatorIdentification,
    identify_actuator,
)
from nrs_design.identification.actuator.model import ActuatorFit, MotorFigures
from nrs_design.models.actuator import THESIS_MOTOR, MotorConstants

__all__ = [
    "THESIS_MOTOR",
    "ActuatorFit",
    "ActuatorIdentification",
    "MotorConstants",
    "MotorFigures",
    "identify_actuator",
]
