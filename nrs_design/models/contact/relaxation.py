"""A spring and a damper in a row: the element that forgets its deflection."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Scalar = TypeVar("Scalar", np.float64, np.complex128)


@dataclass(frozen=True, eq=False)
class Relaxation:
    """The solution of ``y' = -y / tau + ddelta`` from y = 0, exactly.

    The deflection is linear between samples, so that ``y+ = a y + (1 - a)/h Delta`` with
    ``h = dt / tau`` and ``a = exp(-h)`` has no discretization error.
    """

    # steps, increments: shape (n - 1,). Between samples: time in s, and change of the deflection.
    steps: Array
    increments: Array
    time_constant: float  # tau in s

    @cached_property
    def _h(self) -> Array:
        return self.steps / self.time_constant

    @cached_property
    def _a(self) -> Array:
        return np.exp(-self._h)

    @cached_property
    def _gain(self) -> Array:
        return np.asarray(-np.expm1(-self._h) / self._h)

    @cached_property
    def y(self) -> Array:
        """At the samples, shape (n,), in m (rad)."""
        return run_first_order(self._a, self._gain * self.increments)

    @property
    def slope(self) -> Array:
        """The derivative of y by log tau, shape (n,), in m (rad)."""
        a, increments = self._a, self.increments
        return run_first_order(a, a * self._h * self.y[:-1] + (self._gain - a) * increments)


def run_first_order(factors: NDArray[Scalar], inputs: NDArray[Scalar]) -> NDArray[Scalar]:
    """Run ``y[i + 1] = factors[i] y[i] + inputs[i]`` from y[0] = 0, real or complex; n + 1 values.

    Solved as a bidiagonal system, which takes as long as a filter with a constant factor.
    """
    from scipy.linalg.lapack import dtbtrs, ztbtrs

    banded = np.ones((2, len(inputs)), dtype=factors.dtype, order="F")
    banded[1, :-1] = -factors[1:]
    solve = ztbtrs if np.iscomplexobj(inputs) else dtbtrs
    solution, _ = solve(banded, inputs[:, None], uplo="L")
    return np.concatenate([np.zeros(1, solution.dtype), solution[:, 0]])
