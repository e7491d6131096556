"""What a motion law keeps from one tick to the next."""

from __future__ import annotations

from dataclasses import dataclass

from nrs_design.robot.controllers.load_model import LoadTerms
from nrs_design.robot.models.vectors import Array


@dataclass(frozen=True, slots=True)
class LawState:
    """Memory of a law; empty before its first tick."""

    # Tracking error of the last tick in encoder coordinates, shape (n, 3), in rad.
    error: Array | None = None
    load: LoadTerms | None = None  # The model at the last tick

    def error_rate(self, error: Array, period: float) -> Array:
        """Return the backward difference of the error in rad/s; zero at the first tick."""
        return error * 0.0 if self.error is None else (error - self.error) / period
