"""A robot as simulators have it: three open chains, and where their ends meet.

Each leg turns about its base axis (x), then bends in its plane at crank, coupler and arm (z). The
platform is part of the middle arm; the arms of the side legs are hinged to it about the endoscope.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, sin

import numpy as np
from numpy.typing import ArrayLike

from nrs_design.robot.models.geometry import posture
from nrs_design.robot.models.robot import Leg, Robot

PARTS = ("crank", "coupler", "arm")
# The driven joints: the planes of the side legs and the crank of the middle one.
DRIVEN = {"theta1": "left_plane", "theta2": "right_plane", "theta3": "middle_crank"}


@dataclass(frozen=True, slots=True)
class Link:
    """A link that turns about z in the plane of its leg."""

    name: str  # Such as ``left_crank``
    offset: float  # From the joint of the link before to its own joint, along that link, in m
    length: float  # From its joint to the next one, in m
    mass: float  # In kg
    center: tuple[float, ...]  # Center of mass in the frame of the link, in m
    inertia: tuple[tuple[float, ...], ...]  # About the center of mass, in kg m^2


def links_of(robot: Robot, leg: Leg) -> list[Link]:
    """Return crank, coupler and arm of a leg; that of the middle leg carries the platform."""
    bodies = robot.loads[robot.legs.index(leg)]
    spans = ((leg.l0, leg.l1), (leg.l1, leg.l2), (leg.l2, leg.l3))
    return [
        Link(
            f"{leg.name}_{part}",
            offset,
            length,
            body.mass,
            tuple(map(float, body.center_of_mass)),
            tuple(tuple(map(float, row)) for row in body.inertia),
        )
        for part, (offset, length), body in zip(PARTS, spans, bodies, strict=True)
    ]


def joint_names(robot: Robot) -> list[str]:
    """Return all joints in their order, leg by leg from the base on."""
    return [f"{leg.name}_{part}" for leg in robot.legs for part in ("plane", *PARTS)]


def tree_angles(robot: Robot, pose: ArrayLike) -> list[float]:
    """Return the angles of all joints at one pose in rad, as `joint_names` has them.

    Parameters
    ----------
    robot : Robot
        The robot.
    pose : array_like, shape (3,)
        (phi, psi, d), in rad and m.

    Raises
    ------
    PoseError
        If a leg cannot reach the pose.
    """
    closed = posture(robot, np.asarray(pose, dtype=float))
    W, angles = closed.W, []
    for item in closed.legs:
        a = item.leg.axis
        beta = atan2(item.sin_beta, item.cos_beta)
        kappa = atan2(item.sin_kappa, item.cos_kappa)
        # The arm stands at a right angle to the endoscope.
        arm = atan2(item.cos_gamma, -item.sin_gamma)
        plane = atan2(a[1] * W[0] - a[0] * W[1], W[2])
        angles += [plane, beta, _turn(kappa - beta), _turn(arm - kappa)]
    return angles


def attribute_text(*values: float) -> str:
    """Write numbers with all their digits, separated by blanks."""
    return " ".join(repr(float(value)) for value in values)


def _turn(angle: float) -> float:
    """Return the same direction between -pi and pi."""
    return atan2(sin(angle), cos(angle))
