"""What readings of a running loop are worth: bounds on their noise, and where the surface is."""

from __future__ import annotations

from typing import Literal

from nrs_design.spec.check import Row
from nrs_design.spec.model import SpecModel, optional, required
from nrs_design.spec.quantity_fields import Angle, AngularVelocity, Duration, Torque

Surface = Literal["fixed", "free", "touched"]


class MonitoringSpec(SpecModel, stronger="unknown"):
    """Bounds on readings, not standard deviations: of each sample, whatever the others are.

    No proof depends on them. `export --format monitor` and `audit` test the stiffness within them.
    """

    torque_noise: Torque = required(
        "largest error of a reading of the torque in N*m, with bias, drift and half a "
        "step of the sensor: a bound, no standard deviation"
    )
    angle_noise: Angle = required(
        "largest error of a reading of the joint angle in rad: half a step of the "
        "encoder, and what the joint bends between encoder and contact"
    )
    surface: Surface = required(
        "where the surface is that the torque is counted from: fixed (one place for "
        "the whole run), free (it may move while nothing is touched, and stands still from the "
        "last sample before the touch on), or touched (it may move until contact is certain)"
    )
    surface_speed: AngularVelocity | None = optional(
        "how fast the surface may move all the same, in rad/s about the pivot, such as "
        "with a breath; default: it stands still"
    )
    speed: AngularVelocity | None = optional(
        "largest speed of the joint in rad/s, which the monitor tests, too; required "
        "with skew, and for a tissue with damping"
    )
    skew: Duration | None = optional(
        "largest time between the reading of a torque and that of its angle, in s"
    )

    checks = (
        Row(
            "skew",
            lambda s: s.skew is not None and s.speed is None,
            "a skew moves the angle by its speed, which is not given",
            "add `speed: 20 deg/s`, the largest one of the joint",
        ),
    )
