"""The weight of what the middle leg carries, in joint torques, from few operations.

The torques are derivatives of the potential energy: with respect to the depth d and the plane's
angles alpha and gamma of the middle leg, and from there to the joints.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.controllers.trace import Traced
from nrs_design.robot.controllers.traced_endoscope import Endoscope
from nrs_design.robot.controllers.traced_trigonometry import sine_and_cosine
from nrs_design.robot.models.kinematics import coupler_sign
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Scalar, Vector


@dataclass(frozen=True, slots=True)
class _Depth:
    """The depth, and its derivatives by the crank and by gamma, in lengths l0 of the middle leg."""

    d: Scalar
    by_crank: Scalar
    by_gamma: Scalar


def weight(robot: Robot, encoders: Sequence[Traced], ratio: float, gravity: Vector) -> Vector:
    """Return the torques in N m that hold a robot with nothing but what its middle arm carries.

    Parameters
    ----------
    robot : Robot
        Without the masses of its links but the middle arm.
    encoders : sequence of Traced
        Their angles in rad.
    ratio : float
        Turns of an encoder per turn of its joint.
    gravity : tuple
        In the base frame, in m/s^2; or a multiple, for multiples of the torques.
    """
    scope = Endoscope.at(robot, encoders, ratio)
    cos_gamma, sin_gamma, b = scope.cos_gamma, scope.sin_gamma, scope.b
    depth = _depth(robot, encoders[2], ratio, cos_gamma, sin_gamma)
    g_a, g_e, g_z = scope.gravity(robot, gravity)
    g_b, g_k = b[0] * g_e + b[1] * g_z, b[0] * g_z - b[1] * g_e
    g_W = cos_gamma * g_a + sin_gamma * g_b
    g_X = sin_gamma * g_a - cos_gamma * g_b
    # First moments along W, along X across it in the plane, and normal to the plane.
    body, leg = robot.loads[2][2], robot.legs[2]
    mass = body.mass * leg.l0
    on_W, on_X = depth.d * mass - body.first[1], body.mass * leg.l3 - body.first[0]
    on_d = -mass * g_W
    on_gamma = on_W * g_X - on_X * g_W + on_d * depth.by_gamma
    turned = on_X * scope.cot - on_W
    on_alpha = g_k * turned + body.first[2] * g_b * (1.0 / sin_gamma)
    pull = -on_gamma * sin_gamma, on_gamma * cos_gamma * b[0] - on_alpha * b[1]
    on_1, on_2 = (a[0] * pull[0] + a[1] * pull[1] for a in (scope.axes.second, scope.axes.first))
    t1, t2 = scope.tangents
    return (
        -(1.0 + t1 * t1) * scope.per_whole * on_1,
        (1.0 + t2 * t2) * scope.per_whole * on_2,
        on_d * depth.by_crank,
    )


def _depth(
    robot: Robot, encoder: Traced, ratio: float, cos_gamma: Scalar, sin_gamma: Scalar
) -> _Depth:
    """Return the depth that the crank of the middle leg gives (thesis 3.7)."""
    leg, sign = robot.legs[2], coupler_sign(robot)
    l1, l2, l3 = leg.l1 / leg.l0, leg.l2 / leg.l0, leg.l3 / leg.l0
    y, x = sine_and_cosine(encoder, ratio, l1, 1.0)
    across = x * sin_gamma - y * cos_gamma
    along = x * cos_gamma + y * sin_gamma
    missing = l3 - across
    root = np.sqrt(l2 * l2 - missing * missing)
    slope = sign * (missing / root)
    return _Depth(
        along + sign * root,
        across - sin_gamma - slope * (along - cos_gamma),
        slope * along - across,
    )
