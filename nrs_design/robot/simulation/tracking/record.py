"""What one simulated experiment gave."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from nrs_design.robot.models.vectors import Array, root_mean_square
from nrs_design.robot.simulation.tracking.experiment import Experiment

# From rad and m to what the thesis prints of (phi, psi, d).
DISPLAY = np.array([180 / pi, 180 / pi, 1e3])


@dataclass(frozen=True, slots=True)
class TrackingRecord:
    """What one experiment gave."""

    controller: str  # Which one
    experiment: Experiment  # What was asked for
    time: Array  # Ticks in s, shape (n,)
    # wanted, measured, actual: poses (phi, psi, d), shape (n, 3), in rad and m; measured through
    # the encoders.
    wanted: Array
    measured: Array
    actual: Array
    command: Array  # Shape (n, 3), in rpm

    @property
    def rmse(self) -> Array:
        """Root mean square of wanted less measured, shape (3,), in rad and m.

        Over the whole record, with the time that the pose is held.
        """
        return root_mean_square(self.wanted - self.measured)

    @property
    def actual_rmse(self) -> Array:
        """Root mean square of wanted less actual, shape (3,), in rad and m."""
        return root_mean_square(self.wanted - self.actual)

    def summary(self) -> dict[str, Any]:
        """Return what to print: angles in deg, lengths in mm, commands in rpm, times in s."""
        return {
            "controller": self.controller,
            "moved": self.experiment.moved,
            "period": 2 * pi / self.experiment.rate,
            "duration": self.experiment.duration,
            "rmse": (self.rmse * DISPLAY).tolist(),
            "actual_rmse": (self.actual_rmse * DISPLAY).tolist(),
            "largest_command": np.abs(self.command).max(axis=0).tolist(),
        }
