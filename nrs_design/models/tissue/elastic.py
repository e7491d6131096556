"""Elastic tissue, ``F = k delta`` (thesis 2.5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from nrs_design.models.tissue.law import STIFFNESS, AbstractTissueLaw
from nrs_design.models.tissue.motion import Array, Motion


@dataclass(frozen=True)
class Elastic(AbstractTissueLaw):
    """A spring.

    Parameters
    ----------
    k : float
        Stiffness in N/m (N m/rad).
    """

    name: ClassVar[str] = "elastic"
    formula: ClassVar[str] = "F = k δ"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS,)

    k: float

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, in N (N m)."""
        return self.k * motion.deflection

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivative by log k, shape (n, 1)."""
        return self.simulate(motion)[:, None]

    def at_pivot(self, radius: float) -> Elastic:
        """Return ``k r^2`` (thesis 6.3.1.1)."""
        return Elastic(self.k * radius**2)
