"""What cost is traded for, by name; imports nothing, for the command line's help."""

from enum import StrEnum


class Objective(StrEnum):
    """What is to be as large, or as small, as can be proved."""

    STIFFNESS = "stiffness"
    DECAY_RATE = "decay-rate"
    DELAY = "delay"
    PEAK_TORQUE = "peak-torque"
    NOISE = "noise"

    @property
    def is_smallest(self) -> bool:
        """Whether less of it is better."""
        return self in (Objective.PEAK_TORQUE, Objective.NOISE)
