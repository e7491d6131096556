"""A measured deflection as what moves a tissue model: piecewise linear between its samples."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from nrs_design.models.contact.relaxation import Array, Relaxation


@dataclass(frozen=True, eq=False)
class Motion:
    """Deflection over time; the steps need not be equal.

    Between two samples the deflection is taken as linear. Before the first one it is taken to
    have rested there for long, so that a relaxing element carries no force at the start.
    """

    time: Array  # Shape (n,). In s, strictly increasing, n >= 2.
    deflection: Array  # Shape (n,). In m, or in rad at the pivot.

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.time)

    @cached_property
    def steps(self) -> Array:
        """Time from each sample to the next, shape (n - 1,), in s."""
        return np.diff(self.time)

    @cached_property
    def increments(self) -> Array:
        """Change of the deflection from each sample to the next, shape (n - 1,)."""
        return np.diff(self.deflection)

    @cached_property
    def velocity(self) -> Array:
        """Velocity at the samples, shape (n,): second-order differences, per s."""
        order: Literal[1, 2] = 2 if len(self) > 2 else 1
        return np.asarray(np.gradient(self.deflection, self.time, edge_order=order), float)

    @cached_property
    def derivatives(self) -> tuple[Array, Array, Array]:
        """Deflection, velocity and acceleration at the samples, each of shape (n,)."""
        return self.deflection, self.velocity, np.gradient(self.velocity, self.time)

    @property
    def time_constants(self) -> Array:
        """Time constants in s that a record may tell, from short to long."""
        duration = float(self.time[-1] - self.time[0])
        return np.geomspace(2 * float(np.median(self.steps)), 5 * duration, 9)

    def relaxed(self, time_constant: float) -> Relaxation:
        """Return the response of a spring and a damper in a row; time constant in s."""
        return Relaxation(self.steps, self.increments, time_constant)

    def translate(self, shift: float) -> Motion:
        """Return the motion with its deflection counted from so much further; velocities stay."""
        motion = Motion(self.time, self.deflection - shift)
        vars(motion)["velocity"] = self.velocity
        return motion
