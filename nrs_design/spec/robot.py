"""The spec of a robot of the NeuRoboScope's family: two URRR side legs and one URR middle leg."""

from __future__ import annotations

from math import sin
from typing import Annotated, ClassVar, Literal

from nrs_design.spec import quantity_fields as field
from nrs_design.spec.check import Row
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import Name, Positive, Title, read_exact, whole
from nrs_design.spec.model import ParsedBy, SpecModel, optional, required
from nrs_design.spec.motion import CommandUnit, MotionLoopSpec, commands_in

MAX_COUNTS = 1 << 24
# The gradient of speed over torque is about such commands (thesis 4.10).
_DRIVEN_BY: CommandUnit = "rpm"


def _read_elbow_sign(value: object) -> int:
    number = read_exact(value)
    if abs(number) != 1:
        raise fault(f"{value} is neither 1 nor -1", "write 1 or -1")
    return int(number)


ElbowSign = Annotated[int, ParsedBy(_read_elbow_sign, {"type": "integer", "enum": [-1, 1]})]
Counts = Annotated[int, whole(2, MAX_COUNTS)]


class TensorSpec(SpecModel, stronger="neither"):
    """Inertia tensor about the center of mass; products with the sign they have in the tensor."""

    xx: field.MomentOfInertia = required("moment about x in kg*m^2")
    yy: field.MomentOfInertia = required("moment about y in kg*m^2")
    zz: field.MomentOfInertia = required("moment about z in kg*m^2")
    xy: field.ProductOfInertia | None = optional("entry (x, y) of the tensor in kg*m^2; default 0")
    xz: field.ProductOfInertia | None = optional("entry (x, z) of the tensor in kg*m^2; default 0")
    yz: field.ProductOfInertia | None = optional("entry (y, z) of the tensor in kg*m^2; default 0")

    def _excess(self) -> str | None:
        """Return the moment that exceeds the sum of the two others."""
        moments = {"xx": self.xx.si, "yy": self.yy.si, "zz": self.zz.si}
        largest = max(moments, key=lambda name: moments[name])
        return largest if 2 * moments[largest] > sum(moments.values()) else None

    checks = (
        Row(
            "{0}",
            _excess,
            "one moment exceeds the sum of the two others: no body has that inertia",
            "check the three moments",
        ),
    )


class BodySpec(SpecModel, stronger="neither"):
    """A rigid body: mass, center of mass, and inertia as a tensor or as that of a rod."""

    mass: field.Mass = required("mass in kg, >= 0")
    center_of_mass: tuple[field.Coordinate, field.Coordinate, field.Coordinate] = required(
        "center of mass [x, y, z] in the frame of the body, in m"
    )
    inertia: Literal["slender-rod", "tensor"] = required(
        "slender-rod: m l^2/12 about both axes across the length; tensor: as `tensor` says"
    )
    tensor: TensorSpec | None = optional("inertia about the center of mass, with `inertia: tensor`")

    checks = (
        Row(
            "inertia",
            lambda s: (s.inertia == "tensor") != (s.tensor is not None),
            "`inertia: tensor` and `tensor` go together",
            "give both, or `inertia: slender-rod` alone",
        ),
    )


class LegSpec(SpecModel, stronger="neither"):
    """One leg: crank and coupler move in a plane that turns about the leg's base axis."""

    azimuth: field.SignedAngle = required(
        "base axis in the x-y plane of the base, from x towards y"
    )
    elbow_sign: ElbowSign = required(
        "sign in `crank angle = coupler direction + sign * acos(...)`: -1 outwards (thesis 3.10)"
    )
    l0: field.Length = required("pivot to base joint along the base axis, in m")
    l1: field.Length = required("length of the crank, in m")
    l2: field.Length = required("length of the coupler, in m")
    l3: field.Length = required("distance of the coupler's end from the endoscope axis, in m")
    crank: BodySpec = required("first link; x from the base joint, z normal to the leg's plane")
    coupler: BodySpec = required("second link; x from the elbow, z normal to the leg's plane")
    arm: BodySpec = required("third link; x to the endoscope, z normal to the leg's plane")
    axis_inertia: field.MomentOfInertia = required(
        "inertia about the base axis beside the links, such as a rotor's, in kg*m^2"
    )


class LegsSpec(SpecModel, stronger="neither"):
    """The three legs; the middle one carries the platform."""

    left: LegSpec = required("side leg of theta1, the angle of its plane")
    right: LegSpec = required("side leg of theta2, the angle of its plane")
    middle: LegSpec = required("leg of theta3, its crank angle; its arm is rigid with the platform")

    checks = (
        Row(
            "right.azimuth",
            lambda s: abs(sin(s.left.azimuth.si - s.right.azimuth.si)) < 1e-6,
            "the base axes of the side legs are parallel: they cannot point the endoscope",
            "give them different azimuths",
        ),
    )


class PlatformSpec(BodySpec):
    """The mobile platform with the endoscope.

    Its frame has its origin at depth d on the endoscope axis: x towards the middle leg, z along
    the endoscope, y completes a right-handed frame.
    """

    length: field.Length = required("length along the endoscope axis, for slender-rod, in m")


class RobotWorkspaceSpec(SpecModel, stronger="unknown"):
    """Poses that the robot is made for."""

    phi: field.Angle = required("largest |phi| (yaw)")
    psi: field.Angle = required("largest |psi| (pitch)")
    d: field.LengthBounds = required("depth along the endoscope axis, {min: ..., max: ...}")


class TaskLimitsSpec(SpecModel, stronger="unknown"):
    """Largest motion of the endoscope that the task asks for (thesis 3.3)."""

    angular_velocity: field.AngularVelocity = required("of phi and psi, in rad/s")
    linear_velocity: field.LinearVelocity = required("of d, in m/s")
    angular_acceleration: field.AngularAcceleration = required("of phi and psi, in rad/s^2")
    linear_acceleration: field.LinearAcceleration = required("of d, in m/s^2")


class DriveSpec(SpecModel, stronger="neither"):
    """Motor with driver, gearhead, capstan and encoder, equal for all three joints."""

    gain: field.ActuatorGain = required("Km of the gearhead's output in rad/s/rpm (thesis 4.9)")
    time_constant: field.Duration = required("mechanical time constant in s (thesis 4.9)")
    rotor_inertia: field.MomentOfInertia = required("motor and gearhead, at the shaft, in kg*m^2")
    gearhead_ratio: Positive = required("motor turns per turn of the gearhead, no unit")
    capstan_ratio: Positive = required("gearhead turns per turn of the joint, no unit")
    speed_torque_gradient: field.TorqueGradient = required(
        "command per torque at the shaft, rpm/(N*m) (thesis 4.10)"
    )
    coulomb_friction: field.Command = required("dry friction as a command (thesis 4.1)")
    encoder_counts: Counts = required("counts of the encoder per turn of the gearhead's output")

    checks = (
        commands_in(
            lambda _: _DRIVEN_BY,
            lambda s: ((("gain",), s.gain), (("coulomb_friction",), s.coulomb_friction)),
        ),
    )


class RobotControlSpec(SpecModel, stronger="neither"):
    """Motion control of the joints (thesis 4.2 and 4.3)."""

    motion_loop: MotionLoopSpec = required("the position loop around each motor")
    sample_period: field.Duration = required("time between two control ticks, in s")

    checks = (
        commands_in(
            lambda _: _DRIVEN_BY,
            lambda s: ((("motion_loop", "derivative_gain"), s.motion_loop.derivative_gain),),
        ),
    )


class BalancedLegSpec(SpecModel, stronger="neither"):
    """Counter-masses and spring of one side leg (thesis 4.4)."""

    arm_center_of_mass: field.Length = required("G_c of the arm from the coupler's end, in m")
    coupler_counter_arm: field.Length = required(
        "B_b, counter-mass of the coupler, from the elbow, in m"
    )
    arm_counter_arm: field.Length = required(
        "B_c, counter-mass of the arm, from the coupler's end, in m"
    )
    spring_on_crank: field.Length = required("A0C_A, spring on the crank from the base joint")
    spring_on_base: field.Length = required("A0D0, spring on the base from the base joint, in m")


class BalanceSpec(SpecModel, stronger="neither"):
    """Passive balance of the side legs (thesis 4.4)."""

    payload: field.Mass = required("m_p, share of the platform that each side leg carries")
    tilt: field.SignedAngle = required("base tilt for which the springs are anchored")
    left: BalancedLegSpec = required("left leg")
    right: BalancedLegSpec = required("right leg")


class RobotSpec(SpecModel, stronger="unknown"):
    """A parallel robot that moves an endoscope about a pivot point (thesis 3 and 4)."""

    # No certificate is about it, so it has no ranges.
    has_ranges: ClassVar[bool] = False

    kind: Literal["robot"] = required("what this file describes")
    name: Name = required("short name: lower-case letters, digits, '.', '_', '-'", "neither")
    title: Title = optional("one line for people, at most 200 characters", "", stronger="beside")
    gravity: field.Gravity = required("gravitational acceleration, m/s^2", "neither")
    base_tilt: field.SignedAngle = required(
        "theta4 of the base against the vertical (thesis 3.40)", "neither"
    )
    legs: LegsSpec = required("the three legs")
    platform: PlatformSpec = required("mobile platform with the endoscope")
    workspace: RobotWorkspaceSpec = required("poses that the robot is made for")
    task_limits: TaskLimitsSpec = required("largest motion of the endoscope")
    drive: DriveSpec = required("what moves each joint")
    control: RobotControlSpec | None = optional("motion control")
    balance: BalanceSpec | None = optional("passive gravity balance")
