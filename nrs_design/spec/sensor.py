"""The force sensor of an interaction design, and what readings of a running loop are worth."""

from __future__ import annotations

from typing import Annotated, Literal

from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.fields import whole
from nrs_design.spec.model import SpecModel, optional, required

# Every lag is a state more.
HIGHEST_ORDER = 4

Surface = Literal["fixed", "free", "touched"]


class MonitoringSpec(SpecModel, stronger="unknown"):
    """Bounds on each reading, independent of the others; not standard deviations.

    No proof depends on them. `export --format monitor` and `audit` test the stiffness within them.
    """

    torque_noise: field.Torque = required(
        "largest error of a reading of the torque in N*m, all causes; no standard deviation"
    )
    angle_noise: field.Angle = required(
        "largest error of a reading of the angle in rad: half an encoder step, and bending"
    )
    surface: Surface = required(
        "where the surface is that the torque is counted from: fixed (one place for the whole "
        "run), free (moves until the last sample before the touch) or touched (moves until "
        "contact is certain)"
    )
    surface_speed: field.AngularVelocity | None = optional(
        "speed of the surface in rad/s about the pivot, as with a breath; default: it stands still"
    )
    speed: field.AngularVelocity | None = optional(
        "largest speed of the joint in rad/s; required with skew, and for a tissue with damping"
    )
    skew: field.Duration | None = optional(
        "largest time between readings of torque and angle, in s"
    )

    checks = (
        Row(
            "skew",
            lambda s: s.skew is not None and s.speed is None,
            "a skew moves the angle by its speed, which is not given",
            "add `speed: 20 deg/s`, the largest one of the joint",
        ),
    )


class FilterSpec(SpecModel, stronger="neither"):
    """A low-pass of so many equal lags in a row, ``1/(s/cutoff + 1)^order``."""

    order: Annotated[int, whole(1, HIGHEST_ORDER)] = optional(
        f"number of lags, 1 to {HIGHEST_ORDER}, no unit", 1
    )
    cutoff: field.Bandwidth = required("corner frequency of each lag, such as 30 Hz")


class SensorSpec(SpecModel, stronger="larger"):
    """The force signal: its filter, and bounds on its errors.

    Errors that last move the robot in free motion, as an admittance integrates them: the creep.
    """

    bias: field.Torque | None = optional(
        "largest lasting error of the torque in N*m: drift and a tool's weight after taring"
    )
    resolution: field.Torque | None = optional("step of the measured torque in N*m")
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
        """Tell whether it bounds an error."""
        return self.bias is not None or self.resolution is not None
