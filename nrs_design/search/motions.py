"""Motions in contact and free in floating point, and the multipliers of lost contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.balance import mean_norm, scale_states, separating
from nrs_design.search.family import Family, to_floats

Array = NDArray[np.float64]


def free_motions(family: Family) -> Array:
    """Return the free modes in the coordinates of a family, shape (f, n, n)."""
    d = family.exponents
    free = to_floats([mode.A for mode in family.system.free]).reshape(-1, len(d), len(d))
    return scale_states(free, d)


def separating_coordinates(family: Family) -> Array:
    """Return T that makes the mean of the modes' norms round, but leaves the deflection alone."""
    return separating(mean_norm(family.matrices, family.system.time))
