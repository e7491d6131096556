"""A deterministic search on the unit square for objectives with a forbidden region.

The best v of every u, then the best u: along one axis a region that is forbidden is only an end of
an interval, and cannot hold up the search as its slanted edge would in the square. By hand, as the
optimizers of SciPy want constraints that are smooth, or ask for one point after the other.
"""

from __future__ import annotations

import numpy as np

from nrs_design.design.pattern_search import Objective, local_minima
from nrs_design.design.transfer import FloatArray

_COARSE = (33, 49)
_FINE = 7
_ROUNDS = 8
_STARTS = 3


def search_square(objective: Objective, free: tuple[bool, bool]) -> tuple[float, float, float]:
    """Return the best point of the unit square, and the objective there.

    The objective maps arrays u, v to values, infinite where a point is not allowed. A coordinate
    that is not free is 0.
    """
    u = np.linspace(0, 1, _COARSE[0]) if free[0] else np.zeros(1)
    v, values = _best_across(objective, u, moves=free[1])
    starts = np.flatnonzero(local_minima(values[:, None]))
    starts = starts[np.argsort(values[starts], kind="stable")][:_STARTS]
    found = [(values[i], u[i], v[i]) for i in starts]
    if free[0]:
        found += [_refine_along(objective, u[i], moves=free[1]) for i in starts]
    best = min(found, default=(np.inf, 0.0, 0.0))
    return float(best[1]), float(best[2]), float(best[0])


def _best_across(
    objective: Objective, u: FloatArray, *, moves: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the best v of every u, and the objective there."""
    if not moves:
        v = np.zeros(len(u))
        return v, objective(u, v)
    grid = np.broadcast_to(np.linspace(0, 1, _COARSE[1]), (len(u), _COARSE[1]))
    v, values = _best_of(objective, u, grid)
    spacing = 1 / (_COARSE[1] - 1)
    for _ in range(_ROUNDS):
        v, values = _best_of(objective, u, _around(v, spacing))
        spacing *= 2 / (_FINE - 1)
    return v, values


def _best_of(objective: Objective, u: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    repeated = np.broadcast_to(u[:, None], v.shape)
    values = objective(repeated.ravel(), v.ravel()).reshape(v.shape)
    best = values.argmin(axis=1)
    rows = np.arange(len(u))
    return v[rows, best], values[rows, best]


def _refine_along(objective: Objective, start: float, *, moves: bool) -> tuple[float, float, float]:
    """Return objective, u and v of the best point near a start, each u with its best v."""
    u, spacing = start, 1 / (_COARSE[0] - 1)
    best = (np.inf, u, 0.0)
    for _ in range(_ROUNDS):
        tried = _around(np.array([u]), spacing)[0]
        v, values = _best_across(objective, tried, moves=moves)
        index = int(values.argmin())
        best = min(best, (float(values[index]), float(tried[index]), float(v[index])))
        u, spacing = best[1], spacing * 2 / (_FINE - 1)
    return best


def _around(centers: FloatArray, spacing: float) -> FloatArray:
    """Return points around each center, itself among them, that stay on the unit interval."""
    offsets = spacing * np.linspace(-1, 1, _FINE)
    return np.asarray(np.minimum(np.maximum(centers[:, None] + offsets, 0.0), 1.0))
