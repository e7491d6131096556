"""Three tracking experiments of thesis 4.2 to 4.4, and their records."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from nrs_design.robot.models.kinematics import JointMotion, joint_motion
from nrs_design.robot.models.robot import Robot
from nrs_design.robot.models.vectors import Array, root_mean_square

HOLD_TIME = 10.0
# Angular frequencies in rad/s: 2 pi 0.1 of 4.20 to 4.22, 4.34 and 4.35, and 0.0571 of 4.33c and
# 4.37 to 4.39, taken literally: a period of 110 s.
FAST, SLOW = 2 * pi * 0.1, 0.0571
MOTIONS = ("d", "phi", "psi")
# Index of each coordinate in a pose.
COORDINATE = {"phi": 0, "psi": 1, "d": 2}


@dataclass(frozen=True, slots=True)
class Experiment:
    """A pose that is held, then one full period of a sine of one of its coordinates."""

    coordinate: str  # ``d``, ``phi`` or ``psi``
    center: tuple[float, float, float]  # (phi, psi, d) in rad and m
    amplitude: float  # Amplitude of that coordinate in rad or m
    rate: float  # Angular frequency of the sine in rad/s
    hold_time: float = HOLD_TIME  # Time at the center before the sine, in s

    @property
    def duration(self) -> float:
        """Hold and one period in s. The thesis does not say how long its records are."""
        return self.hold_time + 2 * pi / self.rate

    def motion(self, time: Array) -> tuple[Array, Array, Array]:
        """Return pose, velocity and acceleration at times of shape (n,); shapes (n, 3)."""
        phase = self.rate * np.maximum(time - self.hold_time, 0.0)
        swing = np.zeros(3)
        swing[COORDINATE[self.coordinate]] = self.amplitude
        moving = np.where(time < self.hold_time, 0.0, 1.0)[:, None]
        sine, cosine = np.sin(phase)[:, None], np.cos(phase)[:, None]
        return (
            np.array(self.center) + sine * swing,
            moving * self.rate * cosine * swing,
            -(self.rate**2) * sine * swing,
        )

    def reference(self, robot: Robot, time: Array) -> JointMotion:
        """Return the motion of the joints at times of shape (n,); shapes (n, 3)."""
        return joint_motion(robot, *self.motion(time))


def thesis_experiments(
    robot: Robot, controller: str, period: float | None = None
) -> tuple[Experiment, Experiment, Experiment]:
    """Return the experiments on one controller, scaled to the robot's workspace.

    With that of the NeuRoboScope, and no period in s, they are those of the thesis: d moves over
    its whole range at phi = psi = 0; phi and psi move by their largest values at the smallest d, or
    at the middle one for the balanced robot, which is slow, as independent joints are in d (4.33c).
    """
    space, balanced = robot.workspace, controller == "balanced"
    low, high = space.d
    middle = (low + high) / 2
    depth = middle if balanced else low
    slow = {"balanced": MOTIONS, "independent-joint": ("d",)}.get(controller, ())
    if period is None:
        rates = {coordinate: SLOW if coordinate in slow else FAST for coordinate in MOTIONS}
    else:
        rates = dict.fromkeys(MOTIONS, 2 * pi / period)
    return (
        Experiment("d", (0.0, 0.0, middle), (high - low) / 2, rates["d"]),
        Experiment("phi", (0.0, 0.0, depth), space.phi, rates["phi"]),
        Experiment("psi", (0.0, 0.0, depth), space.psi, rates["psi"]),
    )


# From rad and m to what the thesis prints of (phi, psi, d).
DISPLAY = np.array([180 / pi, 180 / pi, 1e3])


@dataclass(frozen=True, slots=True)
class TrackingRecord:
    """What one experiment gave."""

    controller: str  # Which one
    experiment: Experiment  # Reference motion
    time: Array  # Ticks in s, shape (n,)
    # reference, measured, actual: poses (phi, psi, d), shape (n, 3), in rad and m; measured through
    # the encoders.
    reference: Array
    measured: Array
    actual: Array
    command: Array  # Shape (n, 3), in rpm

    @property
    def rmse(self) -> Array:
        """Root mean square of wanted less measured, shape (3,), in rad and m.

        Over the whole record, with the time that the pose is held.
        """
        return root_mean_square(self.reference - self.measured)

    @property
    def actual_rmse(self) -> Array:
        """Root mean square of wanted less actual, shape (3,), in rad and m."""
        return root_mean_square(self.reference - self.actual)

    def summary(self) -> dict[str, Any]:
        """Return what to print: angles in deg, lengths in mm, commands in rpm, times in s."""
        return {
            "controller": self.controller,
            "moved": self.experiment.coordinate,
            "period": 2 * pi / self.experiment.rate,
            "duration": self.experiment.duration,
            "rmse": (self.rmse * DISPLAY).tolist(),
            "actual_rmse": (self.actual_rmse * DISPLAY).tolist(),
            "largest_command": np.abs(self.command).max(axis=0).tolist(),
        }
