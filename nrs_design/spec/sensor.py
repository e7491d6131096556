"""The force sensor of an interaction design: what its signal is, beside the force."""

from __future__ import annotations

from typing import Annotated

from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.fields import whole
from nrs_design.spec.model import SpecModel, optional, required

# Every lag is a state more.
HIGHEST_ORDER = 4


class FilterSpec(SpecModel, stronger="neither"):
    """A low-pass of so many equal lags in a row, ``1/(s/cutoff + 1)^order``."""

    order: Annotated[int, whole(1, HIGHEST_ORDER)] = optional(
        f"number of lags, 1 to {HIGHEST_ORDER}, no unit", 1
    )
    cutoff: field.Bandwidth = required("corner frequency of each lag, such as 30 Hz")


class SensorSpec(SpecModel, stronger="larger"):
    """The force signal: what filters it, and how far it may be off.

    Errors that last move the robot in free motion, as an admittance integrates them: the creep.
    """

    bias: field.Torque | None = optional(
        "largest lasting error of the torque about the pivot, in N*m: after taring, with what "
        "drifts until the next and what a tool's weight leaves"
    )
    resolution: field.Torque | None = optional(
        "step of the measured torque in N*m: an error of half a step"
    )
    filter: FilterSpec | None = optional("low-pass of the force signal: a part of the loop")

    checks = (
        Row(
            "",
            lambda s: not s.model_fields_set,
            "nothing is said of the sensor",
            "add `bias: 5 N*mm`, or remove sensor",
        ),
    )

    @property
    def has_errors(self) -> bool:
        """Whether it says of an error how large it is."""
        return self.bias is not None or self.resolution is not None
