"""The same dynamics from fewer numbers: masses moved between links that share a point.

A point mass in a joint belongs to either of the two links that meet there, and one on the endoscope
axis at depth d to any of the three arms. So a coupler can be left without mass and first moment
along it, and a side arm without first moment; what a processor computes for them mostly vanishes.
"""

from __future__ import annotations

from dataclasses import replace

from nrs_design.robot.models.body import Body, point_mass
from nrs_design.robot.models.robot import Leg, Robot

CENTER = (0.0, 0.0, 0.0)


def lumped(robot: Robot) -> Robot:
    """Return a robot with other masses and the same torques, gravity included."""
    left, right, middle = map(_without_coupler, robot.legs)
    (left, first), (right, second) = map(_balanced_arm, (left, right))
    platform = robot.platform.plus(point_mass(first + second, CENTER))
    return replace(robot, legs=(left, right, middle), platform=platform)


def in_lengths(robot: Robot, length: float) -> Robot:
    """Return the same robot with lengths counted in another one than the meter.

    Torques stay those in N m where accelerations are counted in that length, too.

    Parameters
    ----------
    robot : Robot
        The robot.
    length : float
        In m.
    """
    left, right, middle = (_leg_in_lengths(leg, length) for leg in robot.legs)
    low, high = robot.workspace.d
    return replace(
        robot,
        legs=(left, right, middle),
        platform=_in_lengths(robot.platform, length),
        gravity=robot.gravity / length,
        workspace=replace(robot.workspace, d=(low / length, high / length)),
    )


def _leg_in_lengths(leg: Leg, length: float) -> Leg:
    return replace(
        leg,
        l0=leg.l0 / length,
        l1=leg.l1 / length,
        l2=leg.l2 / length,
        l3=leg.l3 / length,
        crank=_in_lengths(leg.crank, length),
        coupler=_in_lengths(leg.coupler, length),
        arm=_in_lengths(leg.arm, length),
    )


def _in_lengths(body: Body, length: float) -> Body:
    """Return a body with masses in kg times the square of the length in m."""
    first = tuple(length * number for number in body.first)
    return Body(body.mass * length * length, first, body.second)


def _without_coupler(leg: Leg) -> Leg:
    """Move the mass of the coupler to its ends, so that its center stays."""
    coupler, at_end = _taken_at(leg.coupler, leg.l2)
    at_elbow = coupler.mass
    return replace(
        leg,
        crank=leg.crank.plus(point_mass(at_elbow, (leg.l1, 0.0, 0.0))),
        coupler=replace(coupler, mass=0.0),
        arm=leg.arm.plus(point_mass(at_end, CENTER)),
    )


def _balanced_arm(leg: Leg) -> tuple[Leg, float]:
    """Take so much mass from the end of an arm that its center comes to its origin."""
    arm, at_end = _taken_at(leg.arm, leg.l3)
    return replace(leg, arm=arm), at_end


def _taken_at(body: Body, x: float) -> tuple[Body, float]:
    """Take the mass from a point on the x axis that leaves no first moment along it."""
    (first, *others), ((xx, *rest), *rows) = body.first, body.second
    mass = first / x
    left = Body(body.mass - mass, (0.0, *others), ((xx - first * x, *rest), *rows))
    return left, mass
