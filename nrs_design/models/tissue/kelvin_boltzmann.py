"""Kelvin-Boltzmann tissue, the standard linear solid (thesis 2.5)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from nrs_design.models.tissue.law import DAMPING, STIFFNESS, AbstractTissueLaw
from nrs_design.models.tissue.motion import Array, Motion
from nrs_design.models.tissue.relaxation import relax


@dataclass(frozen=True)
class KelvinBoltzmann(AbstractTissueLaw):
    """A spring k2 in a row with a spring k1 beside a damper b.

    Parameters
    ----------
    k1, k2 : float
        Stiffnesses in N/m (N m/rad).
    b : float
        Damping in N s/m (N m s/rad).
    """

    name: ClassVar[str] = "kelvin-boltzmann"
    formula: ClassVar[str] = "F + η3 F' = η1 δ + η2 δ'"
    kinds: ClassVar[tuple[str, ...]] = (STIFFNESS, STIFFNESS, DAMPING)

    k1: float
    k2: float
    b: float

    @classmethod
    def from_eta(cls, eta1: float, eta2: float, eta3: float) -> KelvinBoltzmann:
        """Return the elements that have these coefficients.

        ``k2 = eta2/eta3``, ``k1 = eta1 k2/(k2 - eta1)``, ``b = eta3 (k1 + k2)``.

        Parameters
        ----------
        eta1 : float
            In N/m.
        eta2 : float
            In N s/m.
        eta3 : float
            In s.

        Raises
        ------
        ValueError
            If ``eta2/eta3 <= eta1``: no positive elements have such coefficients.
        """
        k2 = eta2 / eta3
        if not k2 > eta1 > 0:
            raise ValueError(f"eta2/eta3 = {k2:g} must be above eta1 = {eta1:g}, both positive")
        k1 = eta1 * k2 / (k2 - eta1)
        return cls(k1, k2, eta3 * (k1 + k2))

    @property
    def eta(self) -> tuple[float, float, float]:
        """Coefficients eta1 in N/m, eta2 in N s/m and eta3 in s (N m/rad, N m s/rad, s)."""
        total = self.k1 + self.k2
        return self.k1 * self.k2 / total, self.b * self.k2 / total, self.b / total

    @property
    def relaxation_time(self) -> float:
        """``eta3`` in s."""
        return self.eta[2]

    def simulate(self, motion: Motion) -> Array:
        """Return the reaction at the samples, in N (N m).

        The law is a spring eta1 beside a Maxwell element with stiffness ``k2 - eta1``.
        """
        eta1, _, eta3 = self.eta
        return eta1 * motion.deflection + (self.k2 - eta1) * relax(motion, eta3)[0]

    def sensitivities(self, motion: Motion) -> Array:
        """Return its derivatives by log k1, log k2 and log b, shape (n, 3)."""
        eta1, _, eta3 = self.eta
        y, slope = relax(motion, eta3)
        arm = self.k2 - eta1
        # By log eta1, log arm and log eta3, and then by the chain rule.
        inner = np.column_stack([eta1 * motion.deflection, arm * y, arm * slope])
        q = self.k2 / (self.k1 + self.k2)
        chain = np.array([[q, 1 - q, 0.0], [q - 1, 2 - q, 0.0], [q - 1, -q, 1.0]])
        return np.asarray(inner @ chain)

    def at_pivot(self, radius: float) -> KelvinBoltzmann:
        """Return ``k1 r^2``, ``k2 r^2`` and ``b r^2``; the relaxation time stays."""
        factor = radius**2
        return KelvinBoltzmann(self.k1 * factor, self.k2 * factor, self.b * factor)
