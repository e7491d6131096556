"""From a spec to its plant: text and units end here, exact numbers in SI begin."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Literal

from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.contact.environment import Environment, touch_at_once
from nrs_design.models.drive import (
    Drive,
    lagging_drive,
    position_drive,
    torque_drive,
    velocity_drive,
)
from nrs_design.models.interval import Interval
from nrs_design.models.motion_loop import MotionLoop
from nrs_design.models.plant import Plant
from nrs_design.spec.interaction import InteractionDesignSpec
from nrs_design.spec.motion import FollowingSpec, TorqueInterfaceSpec
from nrs_design.spec.quantity import Quantity

if TYPE_CHECKING:
    from nrs_design.models.axis import AxisType
    from nrs_design.models.contact.law import AbstractNonlinearLaw
    from nrs_design.spec.controllers import IdleStatesSpec, Offset
    from nrs_design.spec.sampling import SamplingSpec
    from nrs_design.spec.switching import SwitchingSpec


# Inputs by name: how large each gets, and its unit.
Bounds = Mapping[str, tuple[Fraction, str]]
# A law that is known within a range of deflections, and the written ends of the range.
Preload = tuple["type[AbstractNonlinearLaw]", str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class OperatingConditions:
    """Processor, switching, contact and bounds of a loop; numbers are exact and in SI units."""

    name: str  # Name of the spec
    axis: AxisType  # The axis, which gives the units of its numbers
    switching: SwitchingSpec
    contact: Literal["losable", "kept"] | None  # None: losable where that can be proved
    idle: IdleStatesSpec | None  # Rule of idle states
    offset: Offset  # Source of the offset of the force controllers
    sampling: SamplingSpec | None  # The processor; None in continuous time
    # Shortest and longest time in s from a sample to the moment when its command takes effect.
    command_delay: tuple[Fraction, Fraction]
    constant_delay_key: str | None  # Key of an unknown, constant delay
    disturbances: Bounds | None  # None without declared disturbances
    largest_angle: Fraction | None  # Largest angle of the joint in rad, rounded up
    torque: Fraction  # Limit about the pivot in N m
    velocity: Fraction  # Limit of the velocity command in rad/s, rounded down
    largest_command: Fraction | None  # Limit of the motor command in its unit, rounded down
    command: str  # Unit of the motor command
    largest_integral: Fraction | None  # Limit of the integral of the force error, in rad
    contacted: frozenset[str]  # The environments that some controller touches
    initial_force: Fraction | Literal["largest"] | None  # Goal about saturation, in N m
    preloads: Mapping[str, Preload]  # Preloads of the touched environments
    sensed: bool  # The spec describes a sensor


def build_plant(spec: InteractionDesignSpec) -> Plant:
    """Convert the plant of a spec to exact SI numbers, environments as the pivot sees them."""
    motor, load, loop, drive = spec.actuator, None, None, None
    if spec.torque_interface is not None:
        ranges, load, drive = _torque(spec.torque_interface, spec.command)
        joint = ranges.nominal
        loop = MotionLoop((joint.gain,), (joint.time_constant, Fraction(1)), is_stated=True)
    elif spec.followed is not None:
        ranges, loop = _followed(spec.followed, spec.command)
        drive = _drive(spec, loop)
    else:
        assert motor is not None, "a spec has one of them"
        gain, time_constant = motor.gain.interval, motor.time_constant.interval
        ranges = ActuatorRanges(gain, time_constant, spec.command)
        load = None if motor.load_inertia is None else motor.load_inertia.exact
        stated = None if spec.motion_loop is None else spec.motion_loop.transfer_function
        if stated is not None:
            loop = MotionLoop(stated.numerator, stated.denominator, is_stated=True)
    return Plant(tuple(build_environments(spec)), ranges, loop, load, drive)


def _followed(robot: FollowingSpec, command: str) -> tuple[ActuatorRanges, MotionLoop]:
    """Return the motion loop of a robot, and a lag about as slow where it is another."""
    one, G = Fraction(1), robot.transfer_function
    if G is not None:
        loop = MotionLoop(G.numerator, G.denominator, is_stated=True)
        lag = Interval.point(abs(loop.delay) or one)
    else:
        assert robot.time_constant is not None, "a robot has one of them"
        lag = robot.time_constant.interval
        loop = MotionLoop((one,), (lag.nominal, one), is_stated=True)
    return ActuatorRanges(Interval.point(one), lag, command), loop


def _drive(spec: InteractionDesignSpec, loop: MotionLoop) -> Drive | None:
    if spec.position_interface is not None:
        lag = spec.position_interface.time_constant
        return position_drive(loop) if lag is None else lagging_drive(lag.interval)
    assert spec.velocity_interface is not None
    return velocity_drive(loop) if spec.velocity_interface.time_constant is None else None


def _torque(robot: TorqueInterfaceSpec, command: str) -> tuple[ActuatorRanges, Fraction, Drive]:
    """Return the joint, and the equivalent motor: speed u/B, time constant J/B."""
    J, B = robot.inertia.interval, robot.friction.interval
    gain = Interval(1 / B.nominal, 1 / B.high, 1 / B.low)
    lag = Interval(J.nominal / B.nominal, J.low / B.high, J.high / B.low)
    return ActuatorRanges(gain, lag, command), J.nominal, torque_drive(J, B)


def build_environments(spec: InteractionDesignSpec) -> Iterator[Environment]:
    """Yield every environment of a spec, then the sums of those touched at the same time."""
    known = {}
    for name, written in spec.environments.items():
        turned = written.linear_at_pivot()
        ranges = tuple(turned[key] for key in written.law.keys)
        known[name] = Environment(name, written.law, ranges, nonlinear=written.nonlinear)
    yield from known.values()
    contacts = (contact for c in spec.controllers.values() for contact in c.contacts)
    for contact in dict.fromkeys(contacts):
        if not isinstance(contact, str):
            parts = tuple(known[name] for name in contact)
            losable = spec.contact != "kept" and all(
                spec.environments[n].is_losable for n in contact
            )
            yield touch_at_once(parts, losable=losable)


def build_conditions(spec: InteractionDesignSpec) -> OperatingConditions:
    """Return the conditions of a spec that its loop needs beside plant and gains."""
    limits, disturbed, goals = spec.limits, spec.disturbances, spec.goals
    angle = None if disturbed is None else disturbed.largest_angle
    wanted = None if goals is None else goals.initial_force
    return OperatingConditions(
        name=spec.name,
        axis=spec.axis,
        switching=spec.switching,
        contact=spec.contact,
        idle=spec.idle_states,
        offset=spec.offset,
        sampling=spec.sampling,
        command_delay=spec.late,
        constant_delay_key=None if spec.constant_late is None else ".".join(spec.constant_late),
        disturbances=None if disturbed is None else disturbed.bounds(),
        largest_angle=None if angle is None else angle.not_below,
        torque=limits.torque.exact,
        velocity=limits.velocity.not_above,
        largest_command=None if limits.command is None else limits.command.not_above,
        command=spec.command,
        largest_integral=None if spec.anti_windup is None else spec.anti_windup.clamp.not_above,
        contacted=spec.touched,
        initial_force=wanted.exact if isinstance(wanted, Quantity) else wanted,
        preloads=dict(_preloads(spec)),
        sensed=spec.sensor is not None,
    )


def _preloads(spec: InteractionDesignSpec) -> Iterator[tuple[str, Preload]]:
    for name, environment in spec.environments.items():
        law, ends = environment.nonlinear, environment.preload_range
        if law is not None and ends is not None and name in spec.touched:
            yield name, (law, ends[0].text, ends[1].text)
