"""Where the endoscope points, from few operations: by tangents of the turns of the side planes.

With t1, t2 these tangents and a1, a2 the base axes of the side legs, the endoscope points along ``N
= t2 a1 - t1 a2 + (a1 x a2)``, and it moves by ``-a2 (1 + t1^2)`` and ``a1 (1 + t2^2)`` over the
length of N, less what is along itself. All in the frame of the middle leg's base axis, the
horizontal across it, and the vertical.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.controllers.trace import Traced
from nrs_design.robot.controllers.traced_trigonometry import tangent
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Scalar, Vector


@dataclass(frozen=True, slots=True)
class Axes:
    """Base axes of the side legs, along that of the middle leg and across it."""

    # first, second: in a length that makes the largest number one, and so that the endoscope points
    # upwards.
    first: tuple[float, float]
    second: tuple[float, float]
    up: float  # Of their vector product, in that length
    size: float  # That length: times it they are unit vectors

    @classmethod
    def of(cls, robot: Robot) -> Axes:
        """Return those of a robot."""
        left, right, (x, y, _) = (leg.axis for leg in robot.legs)
        seen = [(x * a[0] + y * a[1], x * a[1] - y * a[0]) for a in (left, right)]
        turn = seen[0][0] * seen[1][1] - seen[0][1] * seen[1][0]
        size = float(np.copysign(np.abs(seen).max(), turn))
        first, second = ((a / size, b / size) for a, b in seen)
        return cls(first, second, turn / size, size)


@dataclass(frozen=True, slots=True)
class Endoscope:
    """Its direction."""

    axes: Axes  # Of the robot
    tangents: tuple[Scalar, Scalar]  # Of the turns of the side planes
    per_whole: Scalar  # One over the length of N
    # cos_gamma, sin_gamma: in the plane of the middle leg.
    cos_gamma: Scalar
    sin_gamma: Scalar
    cot: Scalar  # The cotangent there
    # Direction in the plane of the middle leg across its base axis, in that of the three.
    b: tuple[Scalar, Scalar]

    @classmethod
    def at(cls, robot: Robot, encoders: Sequence[Traced], ratio: float) -> Endoscope:
        """Return it where the encoders are.

        Parameters
        ----------
        robot : Robot
            Its lengths.
        encoders : sequence of Traced
            Angles of the encoders in rad.
        ratio : float
            Turns of an encoder for one of its joint.
        """
        axes = Axes.of(robot)
        t1, t2 = (tangent(angle, ratio) for angle in encoders[:2])
        along, across = (
            one * t2 - other * t1 for one, other in zip(axes.first, axes.second, strict=True)
        )
        square = across * across + axes.up * axes.up
        length = np.sqrt(square)
        per_length = 1.0 / length
        per_whole = 1.0 / np.sqrt(square + along * along)
        b = across * per_length, axes.up * per_length
        return cls(
            axes,
            (t1, t2),
            per_whole,
            along * per_whole,
            length * per_whole,
            along * per_length,
            b,
        )

    def gravity(self, robot: Robot, gravity: Vector) -> Vector:
        """Return gravity along the base axis of the middle leg, across it, and upwards."""
        x, y, _ = robot.legs[2].axis
        return x * gravity[0] + y * gravity[1], x * gravity[1] - y * gravity[0], gravity[2]
