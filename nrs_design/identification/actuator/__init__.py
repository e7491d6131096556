"""The velocity-controlled motor from sinusoid records or a frequency response."""

from nrs_design.models.actuator import THESIS_MOTOR

__all__ = ["THESIS_MOTOR"]
