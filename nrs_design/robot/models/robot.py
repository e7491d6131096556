"""Robot: legs, platform, gravity, workspace and task limits."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from math import cos, sin

import numpy as np

from nrs_design.robot.models.body import MASSLESS, Body, rigid_body, slender_rod
from nrs_design.robot.models.vectors import Array, Vector
from nrs_design.spec import RobotSpec, parse_spec
from nrs_design.spec.robot import BodySpec, LegSpec
from nrs_design.spec.templates import TEMPLATES

LEGS = ("left", "right", "middle")
# From the platform's frame (x towards the middle leg, z along the endoscope) to the frame of the
# middle arm (x towards the endoscope axis, z normal to the leg's plane).
_ARM_FROM_PLATFORM = ((-1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.0, -1.0, 0.0))


@dataclass(frozen=True, slots=True)
class Leg:
    """A crank and a coupler in a plane through the pivot that turns about the base axis."""

    name: str  # ``left``, ``right`` or ``middle``
    azimuth: float  # Direction of the base axis in the base's x-y plane, in rad
    elbow_sign: int  # -1 if the elbow bends outwards (thesis 3.10), 1 if inwards
    # l0, l1, l2, l3: pivot to base joint, crank, coupler, coupler's end to endoscope axis, in m.
    l0: float
    l1: float
    l2: float
    l3: float
    # crank, coupler, arm: moments in the frame of the link. The origin is the joint nearer to the
    # base, x is along the link, z normal to the leg's plane.
    crank: Body
    coupler: Body
    arm: Body
    axis_inertia: float  # Inertia about the base axis of what else turns with the plane, in kg m^2

    @property
    def axis(self) -> Vector:
        """Unit vector of the base axis."""
        return (cos(self.azimuth), sin(self.azimuth), 0.0)

    @property
    def shortest(self) -> float:
        """Distance of coupler end and base joint with the leg folded, in m."""
        return abs(self.l2 - self.l1)

    @property
    def longest(self) -> float:
        """Distance of coupler end and base joint with the leg stretched, in m."""
        return self.l1 + self.l2


@dataclass(frozen=True, slots=True)
class Workspace:
    """Box of poses: largest magnitudes of phi and psi in rad, depth range in m."""

    phi: float
    psi: float
    d: tuple[float, float]


@dataclass(frozen=True, slots=True)
class TaskLimits:
    """Largest motion of the endoscope: rad/s, m/s, rad/s^2 and m/s^2."""

    angular_velocity: float
    linear_velocity: float
    angular_acceleration: float
    linear_acceleration: float


@dataclass(frozen=True)
class Robot:
    """Two side legs and a middle leg that carry a platform (2URRR-URR)."""

    # Left, right, middle. The joints are the plane angles theta1 and theta2 of the side legs and
    # the crank angle theta3 of the middle leg.
    legs: tuple[Leg, Leg, Leg]
    # Moments in a frame with origin at depth d on the endoscope axis, x towards the middle leg and
    # z along the endoscope. The platform is rigidly connected to the arm of the middle leg.
    platform: Body
    gravity: float  # Gravitational acceleration in m/s^2
    base_tilt: float  # theta4 in rad
    workspace: Workspace  # Poses that the robot is made for
    task_limits: TaskLimits  # Largest motion of the endoscope

    @property
    def gravity_vector(self) -> Vector:
        """Gravity in the base frame, ``R01 (0, 0, -g)`` with R01 of thesis 3.40."""
        return (self.gravity * sin(self.base_tilt), 0.0, -self.gravity * cos(self.base_tilt))

    def tilted(self, base_tilt: float) -> Robot:
        """Return the robot on a base that is tilted by theta4, in rad."""
        return replace(self, base_tilt=base_tilt)

    def remove_links(self) -> Robot:
        """Return the robot with nothing but the mass of its platform (thesis 3.3)."""
        left, right, middle = (
            replace(leg, crank=MASSLESS, coupler=MASSLESS, arm=MASSLESS, axis_inertia=0.0)
            for leg in self.legs
        )
        return replace(self, legs=(left, right, middle))

    @cached_property
    def loads(self) -> tuple[tuple[Body, Body, Body], ...]:
        """Crank, coupler and arm of every leg, with the platform as part of the middle arm."""
        carried = self.platform.transform(_ARM_FROM_PLATFORM, (self.legs[2].l3, 0.0, 0.0))
        left, right, middle = ((leg.crank, leg.coupler, leg.arm) for leg in self.legs)
        return left, right, (middle[0], middle[1], middle[2].plus(carried))

    @property
    def moving_mass(self) -> float:
        """Mass of all links and the platform, in kg."""
        return sum(body.mass for loads in self.loads for body in loads)

    @property
    def home(self) -> Array:
        """The pose in the middle of the workspace, (0, 0, d)."""
        return np.array([0.0, 0.0, sum(self.workspace.d) / 2])


def build_robot(spec: RobotSpec) -> Robot:
    """Convert a spec to SI numbers, angles in rad."""
    legs = spec.legs
    space, limits = spec.workspace, spec.task_limits
    return Robot(
        legs=(_leg("left", legs.left), _leg("right", legs.right), _leg("middle", legs.middle)),
        platform=_body(spec.platform, spec.platform.length.si, 2),
        gravity=spec.gravity.si,
        base_tilt=spec.base_tilt.si,
        workspace=Workspace(space.phi.si, space.psi.si, (space.d.min.si, space.d.max.si)),
        task_limits=TaskLimits(
            limits.angular_velocity.si,
            limits.linear_velocity.si,
            limits.angular_acceleration.si,
            limits.linear_acceleration.si,
        ),
    )


def _leg(name: str, spec: LegSpec) -> Leg:
    l0, l1, l2, l3 = spec.l0.si, spec.l1.si, spec.l2.si, spec.l3.si
    return Leg(
        name=name,
        azimuth=spec.azimuth.si,
        elbow_sign=spec.elbow_sign,
        l0=l0,
        l1=l1,
        l2=l2,
        l3=l3,
        crank=_body(spec.crank, l1, 0),
        coupler=_body(spec.coupler, l2, 0),
        arm=_body(spec.arm, l3, 0),
        axis_inertia=spec.axis_inertia.si,
    )


def _body(spec: BodySpec, length: float, axis: int) -> Body:
    center = [coordinate.si for coordinate in spec.center_of_mass]
    tensor = spec.tensor
    if tensor is None:
        return slender_rod(spec.mass.si, center, length, axis)
    xy, xz, yz = (0.0 if q is None else q.si for q in (tensor.xy, tensor.xz, tensor.yz))
    rows = [[tensor.xx.si, xy, xz], [xy, tensor.yy.si, yz], [xz, yz, tensor.zz.si]]
    return rigid_body(spec.mass.si, center, rows)


@cache
def robot_spec() -> RobotSpec:
    """Return the spec that `nrs-design init robot` writes."""
    spec = parse_spec(TEMPLATES["robot"])
    assert isinstance(spec, RobotSpec)
    return spec


@cache
def robot() -> Robot:
    """Return the robot on a level base."""
    return build_robot(robot_spec())
