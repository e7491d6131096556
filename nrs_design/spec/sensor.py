"""The force sensor of an interaction design, and what readings of a running loop are worth."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import Annotated, Literal

from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.fields import whole
from nrs_design.spec.model import SpecModel, optional, required
from nrs_design.spec.quantity import Quantity

# Every lag is a state more.
HIGHEST_ORDER = 4
_AT = "{axis} of {what}, in m along the axes of the sensor"

Surface = Literal["fixed", "free", "touched"]


class MonitoringSpec(SpecModel, stronger="unknown"):
    """Bounds on readings, not standard deviations: of each sample, whatever the others are.

    No proof depends on them. `export --format monitor` and `audit` test the stiffness within them.
    """

    torque_noise: field.Torque = required(
        "largest error of a reading of the torque in N*m, with bias, drift and half a "
        "step of the sensor: a bound, no standard deviation"
    )
    angle_noise: field.Angle = required(
        "largest error of a reading of the joint angle in rad: half a step of the "
        "encoder, and what the joint bends between encoder and contact"
    )
    surface: Surface = required(
        "where the surface is that the torque is counted from: fixed (one place for "
        "the whole run), free (it may move while nothing is touched, and stands still from the "
        "last sample before the touch on), or touched (it may move until contact is certain)"
    )
    surface_speed: field.AngularVelocity | None = optional(
        "how fast the surface may move all the same, in rad/s about the pivot, such as "
        "with a breath; default: it stands still"
    )
    speed: field.AngularVelocity | None = optional(
        "largest speed of the joint in rad/s, which the monitor tests, too; required "
        "with skew, and for a tissue with damping"
    )
    skew: field.Duration | None = optional(
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


class FilterSpec(SpecModel, stronger="neither"):
    """A low-pass of so many equal lags in a row, ``1/(s/cutoff + 1)^order``."""

    order: Annotated[int, whole(1, HIGHEST_ORDER)] = optional(
        f"number of lags, 1 to {HIGHEST_ORDER}, no unit", 1
    )
    cutoff: field.Bandwidth = required("corner frequency of each lag, such as 30 Hz")


class PointSpec(SpecModel, stronger="unknown"):
    """A point, from the origin of the sensor."""

    x: field.Coordinate = required(_AT.format(axis="x", what="the point"))
    y: field.Coordinate = required(_AT.format(axis="y", what="the point"))
    z: field.Coordinate = required(_AT.format(axis="z", what="the point"))

    @property
    def exact(self) -> tuple[Fraction, ...]:
        """The coordinates in m."""
        return (self.x.exact, self.y.exact, self.z.exact)


class CenterSpec(SpecModel, stronger="holding"):
    """A center of mass that is known within ranges, from the origin of the sensor."""

    x: field.RangedCoordinate = required(_AT.format(axis="x", what="the center of mass"))
    y: field.RangedCoordinate = required(_AT.format(axis="y", what="the center of mass"))
    z: field.RangedCoordinate = required(_AT.format(axis="z", what="the center of mass"))


class ToolSpec(SpecModel, stronger="holding"):
    """What hangs on the sensor. Its weight is taken off the signal, with the nominal values."""

    mass: field.RangedMass = required(
        "mass in kg: one quantity, or {nominal: ..., range: [lowest, highest]}"
    )
    center_of_mass: CenterSpec = required("center of mass, from the origin of the sensor")
    gravity: field.Gravity = optional(
        "gravitational acceleration in m/s^2; default: 9.81 m/s^2",
        Quantity("9.81 m/s^2", Fraction("9.81"), "m/s^2"),
    )


# Keys that count with another one only, and how to write that.
_TOOL = "tool: {mass: 0.797 kg, center_of_mass: ...}"
_WITH = (
    ("drift", "tared_every", "tared_every: 600 s"),
    ("tared_every", "drift", "drift: 1e-5 N*m/s"),
    ("pose_error", "tool", _TOOL),
    ("imu_error", "tool", _TOOL),
    ("force_bias", "pivot", "pivot: {x: 0 m, y: 0 m, z: -0.1 m}"),
)


class SensorSpec(SpecModel, stronger="larger"):
    """The force signal: what filters it, and how far it may be off.

    Errors that last move the robot in free motion, as an admittance integrates them: the creep.
    """

    bias: field.Torque | None = optional(
        "largest bias of the torque about the pivot after taring, in N*m"
    )
    force_bias: field.Force | None = optional(
        "largest bias of the measured force after taring, in N; it is a torque about "
        "the pivot if the pivot is not where the sensor is"
    )
    drift: field.TorqueRate | None = optional(
        "largest drift of the bias in N*m/s; with tared_every"
    )
    tared_every: field.Duration | None = optional(
        "longest time between two tarings in s; with drift"
    )
    resolution: field.Torque | None = optional(
        "step of the measured torque in N*m: an error of half a step"
    )
    noise_density: field.NoiseDensity | None = optional(
        "one-sided power density of white noise of the torque, in N^2*m^2*s, which is "
        "(N*m)^2/Hz; in no bound"
    )
    filter: FilterSpec | None = optional("low-pass of the force signal: a part of the loop")
    tool: ToolSpec | None = optional("what hangs on the sensor; its weight is taken off the signal")
    pose_error: field.Angle | None = optional(
        "largest error of the sensor's orientation in the robot, an angle; with tool"
    )
    imu_error: field.Angle | None = optional(
        "largest error of the measured direction of gravity, an angle; with tool"
    )
    pivot: PointSpec | None = optional("the pivot, from the origin of the sensor; default: there")

    def _alone(self) -> Iterator[tuple[str, str, str]]:
        """Yield keys that count with another one only, that one, and how to write it."""
        given = self.model_fields_set
        return (row for row in _WITH if row[0] in given and row[1] not in given)

    checks = (
        Row(
            "",
            lambda s: not s.model_fields_set,
            "nothing is said of the sensor",
            "add `bias: 5 N*mm`, or remove sensor",
        ),
        Row("{0}", _alone, "{0} counts with {1} only", "add `{2}`"),
    )

    @property
    def has_errors(self) -> bool:
        """Whether it says of an error how large it is."""
        tool = self.tool
        numbers = () if tool is None else (tool.mass, *(end for _, end in tool.center_of_mass))
        told = ("bias", "force_bias", "drift", "resolution", "pose_error", "imu_error")
        return any(getattr(self, key) is not None for key in told) or not all(
            number.fixed for number in numbers
        )
