"""One sample of the robot's motion control as operations: the laws of thesis 4.2 to 4.4.

Angles are those of the encoders, commands those of the motors. What holds for a base that stands
still is computed once, by `base`: its gravity and the correction of the simplified dynamics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from nrs_design.controllers.float32 import float32_not_above, to_float32
from nrs_design.controllers.operations import Coefficient, StepLaw, Value
from nrs_design.controllers.parts import BEYOND
from nrs_design.controllers.trace import Trace
from nrs_design.robot.controllers.motion_laws import ComputedTorque, IndependentJoint
from nrs_design.robot.controllers.traced_dynamics import dynamics, is_flat
from nrs_design.robot.controllers.traced_robot import LARGEST_ANGLES, TracedRobot
from nrs_design.robot.controllers.traced_trigonometry import LARGEST_ANGLE, sine_and_cosine
from nrs_design.robot.controllers.traced_weight import weight
from nrs_design.robot.models import Robot, TiltTable
from nrs_design.robot.models.lumped import in_lengths, lumped
from nrs_design.robot.models.vectors import Vector, scale

JOINTS = (1, 2, 3)
# Results beyond it are refused, rpm or N m. Whatever error a controller may remember, the command
# that corrects it is below: a step that is refused keeps its memory, and would be refused again.
LARGEST_RESULT = 1000 * BEYOND
# Digits of the table, as `robot correction` writes it.
TABLE_DIGITS = 6


@dataclass(frozen=True, slots=True)
class Joints:
    """What the laws of a robot have in common."""

    robot: Robot  # The robot
    encoder_ratio: float  # Turns of the encoder per turn of the joint
    # The command of a motor saturates there, rpm; a single-precision number, None for nowhere.
    command: Fraction | None = None

    @property
    def simplified(self) -> Robot:
        """The robot that the thesis simplifies to: its platform and the rotor of its middle leg."""
        left, right, middle = self.robot.without_links().legs
        kept = replace(middle, axis_inertia=self.robot.legs[2].axis_inertia)
        return replace(self.robot, legs=(left, right, kept))

    @property
    def angles(self) -> tuple[Value, ...]:
        """The encoders, up to where the formulas hold."""
        return tuple(
            Value(f"angle_{i}", f"theta{i}", "rad", limit, f"encoder of joint {i}")
            for i, limit in zip(JOINTS, self._limits(self.encoder_ratio), strict=True)
        )

    @property
    def positions(self) -> tuple[Value, ...]:
        """Where the joints should be, up to the same."""
        return tuple(
            Value(f"position_{i}", "", "rad", limit, f"wanted position of joint {i}")
            for i, limit in zip(JOINTS, self._limits(1.0), strict=True)
        )

    @property
    def errors(self) -> tuple[Value, ...]:
        """The memory of a controller: errors of the encoders, twice an angle at most."""
        # A little more than the difference of two angles, which is rounded.
        return tuple(
            Value(f"error_before_{i}", f"e{i} before", "rad", limit, "error a sample ago")
            for i, limit in zip(JOINTS, self._limits(2.0001 * self.encoder_ratio), strict=True)
        )

    def _limits(self, factor: float) -> list[Fraction]:
        return [float32_not_above(Fraction(end * factor)) for end in LARGEST_ANGLES]

    def joints(self, trace: Trace) -> Vector:
        """Return the joint angles that the encoders say."""
        return _each(lambda angle: angle / self.encoder_ratio, trace.values("angle"))


def build_base(joints: Joints, table: TiltTable) -> StepLaw:
    """Return what a base that stands still gives: its gravity, and the correction at its tilt.

    Parameters
    ----------
    joints : Joints
        The robot.
    table : TiltTable
        Correction of the simplified dynamics, at equal distances.
    """
    trace, tilts = Trace(), table.tilt.tolist()
    tilt = trace.value("tilt")
    sine, cosine = sine_and_cosine(tilt)
    half = (tilts[-1] - tilts[0]) / 2
    position = (tilt - tilts[0]) * ((len(tilts) - 1) / (2 * half))
    # A little more than the table: its ends are rounded.
    inside = (tilt - (tilts[0] + half)) * (1 / (half * (1 + 1e-6)))
    names = [f"correction_table_{i}" for i in JOINTS]
    found = {
        "gravity_x": joints.robot.gravity * sine,
        "gravity_z": -joints.robot.gravity * cosine,
        **{
            f"correction_{i}": trace.interpolate(name, position)
            for i, name in zip(JOINTS, names, strict=True)
        },
    }
    tables = [
        Coefficient(name, "", "1", tuple(map(_digits, column)), table=True)
        for name, column in zip(names, table.mean_ratio.T.tolist(), strict=True)
    ]
    limit = float32_not_above(Fraction(LARGEST_ANGLE))
    tilt_value = Value("tilt", "theta4", "rad", limit, "tilt of the base")
    units = dict.fromkeys(found, "1") | {"gravity_x": "m/s^2", "gravity_z": "m/s^2"}
    return _law(trace, (tilt_value,), (), tables, found, {}, units, {inside.name: Fraction(1)})


def build_independent_joint(joints: Joints, law: IndependentJoint) -> StepLaw:
    """Return a PD on each joint; with a load model its weight is fed forward.

    Parameters
    ----------
    joints : Joints
        The robot.
    law : IndependentJoint
        Its gains.
    """
    trace = Trace()
    given = [*joints.angles, *joints.positions]
    numbers = [
        Coefficient("Kp", "Kp", "rpm/rad", (law.motion.Kp,)),
        Coefficient("Kd_over_T", "D", "rpm/rad", (_over(law.motion.Kd, law.period),)),
    ]
    error, feedback = _feedback(trace, joints)
    command = feedback
    if law.load is not None:
        given += _BASE
        numbers.append(_per_torque(law.command_per_torque))
        down, across = (trace.multiply("command_per_torque", g) for g in _gravity(trace)[::2])
        forward = weight(
            joints.simplified, trace.values("angle"), joints.encoder_ratio, (down, 0.0, across)
        )
        command = _sum(command, _product(trace.values("correction"), forward))
    return _controller(trace, joints, given, numbers, error, command)


def build_computed_torque(joints: Joints, law: ComputedTorque) -> StepLaw:
    """Return computed torque with the simplified dynamics (thesis 4.18, corrected).

    Parameters
    ----------
    joints : Joints
        The robot.
    law : ComputedTorque
        Its gains.
    """
    trace = Trace()
    given = [
        *joints.angles,
        *joints.positions,
        *_motion("acceleration", "rad/s^2", "wanted acceleration"),
        *_BASE,
    ]
    numbers = [
        Coefficient("Kp", "Kp", "1/s^2", (to_float32(Fraction(law.Kp)),)),
        Coefficient("Kd_over_T", "D", "1/s^2", (_over(Fraction(law.Kd), law.period),)),
        _per_torque(law.command_per_torque),
    ]
    error, feedback = _feedback(trace, joints)
    pushed = _each(lambda one: one / joints.encoder_ratio, feedback)
    wanted = _sum(trace.values("acceleration"), pushed)
    robot = TracedRobot.at(joints.simplified, joints.joints(trace))
    torques = robot.torques(_gravity(trace), acceleration=wanted)
    forward = _each(lambda torque: trace.multiply("command_per_torque", torque), torques)
    command = _product(trace.values("correction"), forward)
    return _controller(trace, joints, given, numbers, error, command)


def build_inverse_dynamics(joints: Joints) -> StepLaw:
    """Return the torques of a motion by the full dynamics, links and all; no feedback.

    Parameters
    ----------
    joints : Joints
        The robot.
    """
    trace = Trace()
    velocity, acceleration = trace.values("velocity"), trace.values("acceleration")
    torques = _full(trace, joints, velocity, acceleration)
    given = (
        *joints.angles,
        *_motion("velocity", "rad/s", "velocity"),
        *_motion("acceleration", "rad/s^2", "acceleration"),
        *_BASE[:2],
    )
    found = {f"torque_{i}": torque for i, torque in zip(JOINTS, torques, strict=True)}
    units = dict.fromkeys(found, "N*m")
    checks = {torque.positive(): LARGEST_RESULT for torque in torques}
    return _law(trace, given, (), (), found, {}, units, checks)


def _full(trace: Trace, joints: Joints, velocity: Vector, acceleration: Vector) -> Vector:
    """Return the torques of all links, from fewer operations where these are flat."""
    robot, gravity = lumped(joints.robot), _gravity(trace)
    if not is_flat(robot):
        return TracedRobot.at(robot, joints.joints(trace)).torques(gravity, velocity, acceleration)
    length = robot.legs[2].l0
    angles, fall = trace.values("angle"), scale(1 / length, gravity)
    robot = in_lengths(robot, length)
    return dynamics(robot, angles, joints.encoder_ratio, (velocity, acceleration), fall)


def _gravity(trace: Trace) -> Vector:
    """Gravity in the base frame: the base tilts about its y axis."""
    return trace.value("gravity_x"), 0.0, trace.value("gravity_z")


def _feedback(trace: Trace, joints: Joints) -> tuple[Vector, Vector]:
    """Return the errors of the encoders, and a PD of them by backward differences."""
    goals = _each(lambda goal: goal * joints.encoder_ratio, trace.values("position"))
    error = _difference(goals, trace.values("angle"))
    change = _difference(error, trace.values("error_before"))
    proportional = _each(lambda one: trace.multiply("Kp", one), error)
    derivative = _each(lambda one: trace.multiply("Kd_over_T", one), change)
    return error, _sum(proportional, derivative)


def _controller(
    trace: Trace,
    joints: Joints,
    given: Sequence[Value],
    numbers: Sequence[Coefficient],
    error: Vector,
    command: Vector,
) -> StepLaw:
    """Return a law from encoders to commands, which remembers the errors."""
    checks = {one.positive(): LARGEST_RESULT for one in command}
    if joints.command is not None:
        numbers = [*numbers, Coefficient("command_limit", "", "rpm", (joints.command,))]
        command = _each(lambda one: trace.saturate("command_limit", one), command)
    found = {f"command_{i}": one for i, one in zip(JOINTS, command, strict=True)}
    following = {state.name: e for state, e in zip(joints.errors, error, strict=True)}
    units = dict.fromkeys(found, "rpm")
    return _law(trace, given, joints.errors, numbers, found, following, units, checks)


def _law(
    trace: Trace,
    inputs: Sequence[Value],
    states: Sequence[Value],
    numbers: Sequence[Coefficient],
    outputs: Mapping[str, Any],
    following: Mapping[str, Any],
    units: Mapping[str, str],
    checks: Mapping[str, Fraction],
) -> StepLaw:
    made = {name: value.positive() for name, value in outputs.items()}
    after = {name: value.positive() for name, value in following.items()}
    kept = trace.used((*made.values(), *after.values(), *checks))
    used = {operation.left for operation in kept}
    inline = (c for c in trace.constants.values() if c.name in used)
    return StepLaw(
        (),
        tuple(inputs),
        tuple(states),
        (*numbers, *inline),
        tuple(kept),
        made,
        after,
        units,
        checks,
    )


def _motion(name: str, unit: str, meaning: str) -> Sequence[Value]:
    return [_unguarded(f"{name}_{i}", unit, f"{meaning} of joint {i}") for i in JOINTS]


def _unguarded(name: str, unit: str, meaning: str) -> Value:
    """Return an input of which a wrong value shows in the results, which are checked."""
    return Value(name, "", unit, BEYOND, meaning, guarded=False)


_BASE = (
    _unguarded("gravity_x", "m/s^2", "from the base"),
    _unguarded("gravity_z", "m/s^2", "from the base"),
    *(_unguarded(f"correction_{i}", "1", "from the base") for i in JOINTS),
)


def _per_torque(number: float) -> Coefficient:
    return Coefficient("command_per_torque", "", "rpm/(N*m)", (to_float32(Fraction(number)),))


def _over(gain: Fraction, period: float) -> Fraction:
    return to_float32(gain / Fraction(period))


def _digits(number: float) -> Fraction:
    return to_float32(Fraction(f"{number:.{TABLE_DIGITS}f}"))


def _each(function: Any, values: Vector) -> Vector:
    first, second, third = map(function, values)
    return first, second, third


def _sum(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def _difference(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _product(a: Vector, b: Vector) -> Vector:
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]
