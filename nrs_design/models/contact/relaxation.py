"""A spring and a damper in a row: the element that forgets its deflection."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.models.recursion import run_first_order

if TYPE_CHECKING:
    from nrs_design.models.contact.motion import Array, Motion


@dataclass(frozen=True, eq=False)
class Relaxation:
    """The solution of ``y' = -y / tau + ddelta`` from y = 0, exactly.

    The deflection is linear between samples, so that ``y+ = a y + (1 - a)/h Delta`` with
    ``h = dt / tau`` and ``a = exp(-h)`` has no discretization error.
    """

    motion: Motion  # Deflection, n samples
    time_constant: float  # tau in s

    @cached_property
    def _h(self) -> Array:
        return self.motion.steps / self.time_constant

    @cached_property
    def _a(self) -> Array:
        return np.exp(-self._h)

    @cached_property
    def _gain(self) -> Array:
        return np.asarray(-np.expm1(-self._h) / self._h)

    @cached_property
    def y(self) -> Array:
        """At the samples, shape (n,), in m (rad)."""
        return run_first_order(self._a, self._gain * self.motion.increments)

    @property
    def slope(self) -> Array:
        """The derivative of y by log tau, shape (n,), in m (rad)."""
        a, increments = self._a, self.motion.increments
        return run_first_order(a, a * self._h * self.y[:-1] + (self._gain - a) * increments)
