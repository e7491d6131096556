"""Maxwell tissue, ``F + (b/k) dF = b ddelta`` (thesis 2.5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from nrs_design.models.tissue.law import DAMPING, STIFFNESS, AbstractTissueLaw
from nrs_design.models.tissue.motion import Array, Motion
from nrs_design.models.tissue.relaxation import relax


@dataclass(frozen=True)
class Maxwell(AbstractTissueLaw):
    """A spring and a damper in a row.

    Parameters
    ----------
    k : float
        Stiffness in N/m (N m/rad).
    b : float
        Damping in N s/m (N m s/rad).
    """

    name: ClassVar[str] = "maxwell"
    formula: ClassVar[str] = "F + (b/k) F' = b δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, DAMPING)

    k: float
    b: float

    @property
    def relaxation_time(self) -> float:
        """``b/k`` in s."""
        return self.b / self.k

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, in N (N m)."""
        return self.k * relax(motion, self.relaxation_time)[0]

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log k and log b, shape (n, 2)."""
        y, slope = relax(motion, self.relaxation_time)
        return np.column_stack([self.k * (y - slope), self.k * slope])

    def at_pivot(self, radius: float) -> Maxwell:
        """Return ``k r^2`` and ``b r^2``."""
        return Maxwell(self.k * radius**2, self.b * radius**2)
