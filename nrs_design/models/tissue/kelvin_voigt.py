"""Kelvin-Voigt tissue, ``F = k delta + b ddelta`` (thesis 2.5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from nrs_design.models.tissue.law import DAMPING, STIFFNESS, AbstractTissueLaw
from nrs_design.models.tissue.motion import Array, Motion


@dataclass(frozen=True)
class KelvinVoigt(AbstractTissueLaw):
    """A spring beside a damper.

    Parameters
    ----------
    k : float
        Stiffness in N/m (N m/rad).
    b : float
        Damping in N s/m (N m s/rad).
    """

    name: ClassVar[str] = "kelvin-voigt"
    formula: ClassVar[str] = "F = k δ + b δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, DAMPING)

    k: float
    b: float

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, in N (N m)."""
        return self.k * motion.deflection + self.b * motion.velocity

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log k and log b, shape (n, 2)."""
        return np.column_stack([self.k * motion.deflection, self.b * motion.velocity])

    def at_pivot(self, radius: float) -> KelvinVoigt:
        """Return ``k r^2`` and ``b r^2``."""
        return KelvinVoigt(self.k * radius**2, self.b * radius**2)
