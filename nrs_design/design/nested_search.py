"""The one global search for gains: deterministic, on the unit square, walls allowed.

The best v of every u, then the best u: along one axis a region that is forbidden is only an end of
an interval, and cannot hold up the search as its slanted edge would in the square, nor can a valley
with kinked walls. By hand, as the optimizers of SciPy want constraints that are smooth, or ask for
one point after the other; `differential_evolution` finds no less, by chance (`benchmarks/`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from nrs_design.design.transfer import FloatArray

Objective = Callable[[FloatArray, FloatArray], FloatArray]

_COARSE = (33, 49)
_FINE = 7
_ROUNDS = 10
_STARTS = 3
# Where u is refined, v is looked for so many coarse steps about what was the best.
_WINDOW = 6


def search_square(objective: Objective, free: tuple[bool, bool]) -> tuple[float, float, float]:
    """Return the best point of the unit square, and the objective there.

    The objective maps arrays u, v to values, infinite where a point is not allowed. A coordinate
    that is not free is 0.
    """
    u = np.linspace(0, 1, _COARSE[0]) if free[0] else np.zeros(1)
    grid = np.linspace(0, 1, _COARSE[1]) if free[1] else np.zeros(1)
    v, values = _best_across(objective, u, np.tile(grid, (len(u), 1)))
    beside = np.pad(values, 1, constant_values=np.inf)
    lowest = np.isfinite(values) & (values <= beside[:-2]) & (values <= beside[2:])
    starts = np.flatnonzero(lowest)
    starts = starts[np.argsort(values[starts], kind="stable")][:_STARTS]
    found = [(float(values[i]), float(u[i]), float(v[i])) for i in starts]
    if free[0]:
        found = [_refined_along(objective, *start, moves=free[1]) for start in found]
    value, *point = min(found, default=(np.inf, 0.0, 0.0))
    return point[0], point[1], value


def _refined_along(
    objective: Objective, value: float, u: float, v: float, *, moves: bool
) -> tuple[float, float, float]:
    """Return objective, u and v of the best point near a start, each u with its best v."""
    best, spacing = (value, u, v), 1 / (_COARSE[0] - 1)
    steps = np.arange(-_WINDOW, _WINDOW + 1) / (_COARSE[1] - 1) if moves else np.zeros(1)
    for _ in range(_ROUNDS):
        tried = _around(np.array([best[1]]), spacing)[0]
        window = np.clip(best[2] + steps, 0.0, 1.0)
        across, values = _best_across(objective, tried, np.tile(window, (len(tried), 1)))
        i = int(values.argmin())
        best = min(best, (float(values[i]), float(tried[i]), float(across[i])))
        spacing *= 2 / (_FINE - 1)
    return best


def _best_across(
    objective: Objective, u: FloatArray, grid: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the best v of every u, beginning with a row of a grid, and the objective there."""
    v, values = _best_of(objective, u, grid)
    spacing = 1 / (_COARSE[1] - 1)
    for _ in range(_ROUNDS if grid.shape[1] > 1 else 0):
        v, values = _best_of(objective, u, _around(v, spacing))
        spacing *= 2 / (_FINE - 1)
    return v, values


def _best_of(objective: Objective, u: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    repeated = np.broadcast_to(u[:, None], v.shape)
    values = objective(repeated.ravel(), v.ravel()).reshape(v.shape)
    best = values.argmin(axis=1)
    rows = np.arange(len(u))
    return v[rows, best], values[rows, best]


def _around(centers: FloatArray, spacing: float) -> FloatArray:
    """Return points around each center, itself among them, that stay on the unit interval."""
    offsets = spacing * np.linspace(-1, 1, _FINE)
    return np.asarray(np.minimum(np.maximum(centers[:, None] + offsets, 0.0), 1.0))
