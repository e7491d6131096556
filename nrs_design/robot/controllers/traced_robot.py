"""The robot's formulas on traced values: from joint angles to its pose, and to joint torques.

What is recorded here is `nrs_design.robot.models` itself, so that a processor computes the model
that the tests compare with others. Sine and cosine are polynomials: functions of libm round
differently from one library to the next.
"""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.robot.controllers.traced_trigonometry import (
    LARGEST_ANGLE,
    LARGEST_PLANE_ANGLE,
    sine_and_cosine,
)
from nrs_design.robot.models.dynamics import joint_torques
from nrs_design.robot.models.geometry import Driven, Posture, close_loops
from nrs_design.robot.models.kinematics import coupler_sign
from nrs_design.robot.models.motion import driven_by
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Scalar, Vector, cross, dot, scale

LARGEST_ANGLES = (LARGEST_PLANE_ANGLE, LARGEST_PLANE_ANGLE, LARGEST_ANGLE)
RESTING: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class TracedRobot:
    """A robot at joint angles that are not known yet."""

    robot: Robot  # With its links, or without those that a law does not know of
    closed: Posture  # Where its links are

    @classmethod
    def at(cls, robot: Robot, joints: Vector) -> TracedRobot:
        """Return the robot at joint angles in rad."""
        angles = [sine_and_cosine(joint) for joint in joints]
        left, right = (
            _plane_normal(leg.axis, *angle)
            for leg, angle in zip(robot.legs[:2], angles, strict=False)
        )
        crossed = cross(left, right)
        # Upright planes cross the same way everywhere, that of their axes.
        (first, second), (_, one), (_, other) = robot.legs[:2], *angles[:2]
        turn = first.axis[0] * second.axis[1] - first.axis[1] * second.axis[0]
        per_length = (1.0 if turn > 0 else -1.0) / dot(crossed, crossed).sqrt()
        W = scale(per_length, crossed)
        # The sine of gamma is the product of one base axis with the normal of the other plane.
        sines = (turn * other * per_length, turn * one * per_length)
        sine, cosine = angles[2]
        driven = Driven((left, right), sines, (cosine, sine))
        return cls(robot, close_loops(robot, W, _depth(robot, W, sine, cosine), driven))

    def torques(
        self, gravity: Vector, velocity: Vector = RESTING, acceleration: Vector = RESTING
    ) -> Vector:
        """Return the joint torques of a motion in N m.

        Parameters
        ----------
        gravity : tuple
            In the base frame, in m/s^2.
        velocity, acceleration : tuple
            Of the joints, in rad/s and rad/s^2.
        """
        motion = driven_by(self.closed, velocity, acceleration)
        return joint_torques(self.closed, motion, self.robot, gravity)


def _plane_normal(axis: Vector, sine: Scalar, cosine: Scalar) -> Vector:
    """Return the normal of a plane that has turned from the vertical by an angle."""
    return axis[1] * cosine, -axis[0] * cosine, -sine


def _depth(robot: Robot, W: Vector, sine: Scalar, cosine: Scalar) -> Scalar:
    """Return the depth in m that the crank of the middle leg gives (thesis 3.7)."""
    leg = robot.legs[2]
    cos_gamma = dot(leg.axis, W)
    sin_gamma = (1.0 - cos_gamma * cos_gamma).sqrt()
    x, y = leg.l0 + leg.l1 * cosine, leg.l1 * sine
    across = leg.l3 - (x * sin_gamma - y * cos_gamma)
    square = leg.l2 * leg.l2 - across * across
    return x * cos_gamma + y * sin_gamma + coupler_sign(robot) * square.sqrt()
