"""What cost is traded for, by name; imports nothing, for the command line's help."""

from enum import StrEnum


class Objective(StrEnum):
    """What is to be as large as can be proved."""

    STIFFNESS = "stiffness"
    DECAY_RATE = "decay-rate"
