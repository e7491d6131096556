"""A robot as simulators have it: three open chains, and where their ends meet.

Each leg turns about its base axis (x), then bends in its plane at crank, coupler and arm (z). The
platform is part of the middle arm; the arms of the side legs are hinged to it about the endoscope.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, sin

import numpy as np
from numpy.typing import ArrayLike

from nrs_design import __version__
from nrs_design.models.robot import Leg, Robot, inverse_kinematics, posture
from nrs_design.ownership import MARK
from nrs_design.printable import printable
from nrs_design.spec import LoadedSpec

PARTS = ("crank", "coupler", "arm")
# The driven joints: the planes of the side legs and the crank of the middle one.
DRIVEN = {"theta1": "left_plane", "theta2": "right_plane", "theta3": "middle_crank"}


@dataclass(frozen=True, slots=True)
class RobotExport:
    """What a format of a robot is rendered from.

    Parameters
    ----------
    loaded : LoadedSpec
        Where it comes from.
    robot : Robot
        What it says.
    origin : str
        Where its spec is, seen from the file; see `nrs_design.ownership`.
    """

    loaded: LoadedSpec
    robot: Robot
    origin: str


@dataclass(frozen=True, slots=True)
class Link:
    """A link that turns about z in the plane of its leg.

    Parameters
    ----------
    name : str
        Such as ``left_crank``.
    offset : float
        From the joint of the link before to its own joint, along that link, in m.
    length : float
        From its joint to the next one, in m.
    mass : float
        In kg.
    center : tuple of float
        Center of mass in the frame of the link, in m.
    inertia : tuple of tuple of float, 3 x 3
        About the center of mass, in kg m^2.
    """

    name: str
    offset: float
    length: float
    mass: float
    center: tuple[float, ...]
    inertia: tuple[tuple[float, ...], ...]


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


def home_joints(robot: Robot) -> list[float]:
    """Return theta1 to theta3 in the middle of the workspace, in rad."""
    return [float(angle) for angle in inverse_kinematics(robot, robot.home)]


def comment(export: RobotExport, format_: str, lines: Sequence[str]) -> str:
    """Return the comment that a file begins with, as XML.

    Parameters
    ----------
    export : RobotExport
        With the spec.
    format_ : str
        Its name.
    lines : sequence of str
        What is to be said besides.
    """
    spec = export.loaded.spec
    text = [
        f"nrs-design {format_} of {spec.name}, nrs-design {__version__}",
        f"spec: {spec.name}, sha256 {export.loaded.sha256}",
        f"{MARK}{export.origin}",
        "verdict: none, this is a model of a robot, and nothing is proved of it",
        "units: SI, angles in rad; base frame with its origin in the pivot, x towards the middle "
        "leg, z along the endoscope at phi = psi = 0",
        f"driven joints: {', '.join(f'{theta} = {name}' for theta, name in DRIVEN.items())}",
        "left out: motors, friction, springs and counter-masses of the balance, limits of joints, "
        "contacts",
        *lines,
    ]
    # Two hyphens would end a comment.
    return "<!-- " + "\n     ".join(map(printable, text)).replace("--", "- -") + " -->\n"


def numbers(*values: float) -> str:
    """Write numbers with all their digits, separated by blanks."""
    return " ".join(repr(float(value)) for value in values)


def _turn(angle: float) -> float:
    """Return the same direction between -pi and pi."""
    return atan2(sin(angle), cos(angle))
