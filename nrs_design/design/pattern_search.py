"""Two deterministic searches on the unit square.

Both look for the best v of every u first. `refine` runs a pattern search from several points of
that valley side by side. `search_square` is for objectives with a forbidden region: it looks for
the best u with its best v, because along one axis a forbidden region is only an end of an interval,
and its slanted edge cannot hold the search.
By hand, as the optimizers of SciPy ask for one point after the other, or want smooth constraints:
`differential_evolution` finds the same optimum in twenty times the time (see `benchmarks/`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.design.transfer import BoolArray, FloatArray

Objective = Callable[[FloatArray, FloatArray], FloatArray]

_MAX_ROUNDS = 100
_LEAST_PROGRESS = 1e-10


@dataclass(frozen=True, eq=False)
class Points:
    """Points of the unit square that are searched side by side."""

    # u, v: shape (m,). Coordinates, 0 to 1.
    u: FloatArray
    v: FloatArray
    step: FloatArray  # Shape (2,). Size of the pattern in u and v; 0 holds a coordinate.
    slope: FloatArray  # Shape (m,). Direction dv/du of the valley at each point.


def refine(objective: Objective, start: Points, tolerance: float) -> Points:
    """Search from every point on a 5 x 5 pattern that moves while it improves, else shrinks.

    The pattern is sheared along the valley, whose walls are kinks: a pattern across it would
    find every neighbor higher and stop halfway down. A search ends at the tolerance, the size of
    its pattern. The objective is infinite where a point is not allowed.
    """
    offsets = start.step * _pattern(start.step > 0)
    u, v, scale = start.u.copy(), start.v.copy(), np.ones(len(start.u))
    for _ in range(_MAX_ROUNDS):
        rows = np.flatnonzero(scale * start.step.max() > tolerance)
        if not len(rows):
            break
        moves = scale[rows, None, None] * offsets
        across = moves[..., 1] + start.slope[rows, None] * moves[..., 0]
        tried_u = _onto_square(u[rows, None] + moves[..., 0])
        tried_v = _onto_square(v[rows, None] + across)
        costs = objective(tried_u.ravel(), tried_v.ravel()).reshape(tried_u.shape)
        costs[:, 0] -= _LEAST_PROGRESS  # rounding noise must not count as progress
        best = np.argmin(costs, axis=1)
        u[rows], v[rows] = (tried[np.arange(len(rows)), best] for tried in (tried_u, tried_v))
        scale[rows] = np.where(best == 0, scale[rows] / 4, np.minimum(1, 2 * scale[rows]))
    return replace(start, u=u, v=v)


def _onto_square(w: FloatArray) -> FloatArray:
    """Clip to 0 to 1; for few numbers this takes half the time of `numpy.clip`."""
    return np.minimum(np.maximum(w, 0.0), 1.0)


def _pattern(free: BoolArray) -> FloatArray:
    """Return the offsets in u and v, the center first; a parameter that is not free stays."""
    axes = [[0.0, -1.0, 1.0, -2.0, 2.0] if moves else [0.0] for moves in free]
    return np.array([(i, j) for i in axes[0] for j in axes[1]])


def snap(
    objective: Objective, u: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Move points within 0.01 of an edge onto it where that costs nothing; return their costs too.

    An objective that is flat near an edge lets rounding hide the last step there.
    """
    edge_u, edge_v = (np.where(np.abs(w - np.round(w)) < 0.01, np.round(w), w) for w in (u, v))
    edges = ((edge_u, v), (u, edge_v), (edge_u, edge_v))
    tried_u, tried_v = (np.concatenate(tried) for tried in zip((u, v), *edges, strict=True))
    costs, *trials = objective(tried_u, tried_v).reshape(4, len(u))
    for (to_u, to_v), trial in zip(edges, trials, strict=True):
        gain = trial <= costs * (1 + 1e-12)
        u, v = np.where(gain, to_u, u), np.where(gain, to_v, v)
        costs = np.where(gain, trial, costs)
    return u, v, costs


def lowest_minima(values: FloatArray, most: int) -> NDArray[np.intp]:
    """Return where no neighbor undercuts a finite value, the lowest first, so many at most."""
    padded = np.pad(values, 1, constant_values=np.inf)
    local = np.isfinite(values) & (values <= padded[:-2]) & (values <= padded[2:])
    places = np.flatnonzero(local)
    return places[np.argsort(values[places], kind="stable")][:most]


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
    v, values = best_across(objective, u, moves=free[1])
    starts = lowest_minima(values, _STARTS)
    found = [(values[i], u[i], v[i]) for i in starts]
    if free[0]:
        found += [_refine_along(objective, u[i], moves=free[1]) for i in starts]
    best = min(found, default=(np.inf, 0.0, 0.0))
    return float(best[1]), float(best[2]), float(best[0])


def best_across(
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
        v, values = best_across(objective, tried, moves=moves)
        index = int(values.argmin())
        best = min(best, (float(values[index]), float(tried[index]), float(v[index])))
        u, spacing = best[1], spacing * 2 / (_FINE - 1)
    return best


def _around(centers: FloatArray, spacing: float) -> FloatArray:
    """Return points around each center, itself among them, that stay on the unit interval."""
    offsets = spacing * np.linspace(-1, 1, _FINE)
    return np.asarray(np.minimum(np.maximum(centers[:, None] + offsets, 0.0), 1.0))
