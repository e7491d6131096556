"""Parts of a step: states, numbers and operations of a control law around the motion loop.

A program lists the parts of all its laws once. A law without a part gives its numbers as zero
there, or as what a sample leaves of idle states: products with zero and one are exact, so what is
absent in a mode rounds nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from nrs_design.controllers.operations import Operation, Value

# Limit by default: no robot gets there, and nothing overflows.
DEFAULT_LIMIT = Fraction(1_000_000)
# Placeholder operand for the force sample, or for the last lag of the force filter.
FORCE = "force"
# Gain from the force to the torque that a law subtracts.
FORCE_GAIN = "Kf_torque"
# Inputs: velocity of the hand, commanded position, wanted force.
HAND = Value("velocity_command", "v", "rad/s", DEFAULT_LIMIT, "velocity that the hand commands")
POSITION = Value("position", "X", "rad", DEFAULT_LIMIT, "commanded position", "angle")
TARGET_TORQUE = Value("wanted_torque", "Fd", "N*m", DEFAULT_LIMIT, "wanted torque of the contact")


@dataclass(frozen=True, slots=True)
class StepGain:
    """A number of a part, by mode."""

    # As the exported code, and as formulas call it.
    name: str
    symbol: str
    unit: str
    # Common number of all laws with the part; None if laws have different numbers.
    fixed: Fraction | None = None
    # Symbol of the decay factor of a state while laws without the part are active; empty for zero.
    idle: str = ""
    # All laws with the part may hold the same number.
    common: bool = False


@dataclass(frozen=True, slots=True)
class StepPart:
    """Operations that laws share."""

    name: str
    gains: tuple[StepGain, ...] = ()
    inputs: tuple[Value, ...] = ()
    # Reference state of the part, and the other states.
    place: Value | None = None
    states: tuple[Value, ...] = ()
    # Operations before the error of the motion loop. `adds` names the result that is added to the
    # commanded position; `total` names the sum with the results of earlier parts.
    reference_operations: tuple[Operation, ...] = ()
    adds: str = ""
    total: str = ""
    # After the command, and the result that follows each state.
    state_operations: tuple[Operation, ...] = ()
    following: Mapping[str, str] = field(default_factory=dict)


# Position and force control share their place in a program: a correction of the commanded position.
PROPORTIONAL = StepPart(
    "proportional",
    (StepGain("Kf", "Kp", "rad/(N*m)"),),
    (POSITION, TARGET_TORQUE),
    reference_operations=(
        Operation("lack", "subtract", "wanted_torque", FORCE),
        Operation("correction", "multiply", "Kf", "lack"),
    ),
    adds="correction",
)
