"""The lowest point of a function on the unit square, by a deterministic search.

The best v of every u makes a valley. From the lowest minima along it, a pattern search moves before
it shrinks, so that a minimum away from its start is still reached, also along the edge of what is
allowed. By hand, as the optimizers of SciPy ask for one point after the other, or want smooth
constraints: `differential_evolution` finds the same optimum in twenty times the time (see
`benchmarks/`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from nrs_design.design.transfer import FloatArray

Objective = Callable[[FloatArray, FloatArray], FloatArray]

TOLERANCE = 1e-5  # Size of the pattern at which a search ends
# Coordinates u of the valley, minima along it from which the search starts, and its first pattern.
_ACROSS, _STARTS, _STEP = 25, 4, (1 / 96, 1 / 160)
# Coordinates v of the valley: at first, and around the best of them in each round.
_COARSE, _FINE, _ROUNDS = 49, 7, 8
# Offsets of the pattern in u and v, the center first.
_PATTERN = np.array([*product((0.0, -1.0, 1.0, -2.0, 2.0), repeat=2)])
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


def lowest_on_square(
    coarse: Objective, objective: Objective, free: tuple[bool, bool]
) -> tuple[float, float, float]:
    """Return the lowest point of the unit square, and the objective there.

    The objective maps arrays u, v to values, infinite where a point is not allowed; the coarse one
    is near to it and quick. A coordinate that is not free is 0.
    """
    start = _valley(coarse, free)
    if not len(start.u):
        return 0.0, 0.0, np.inf
    found = refine(objective, start)
    u, v, values = snap(objective, found.u, found.v)
    best = int(values.argmin())
    return float(u[best]), float(v[best]), float(values[best])


def _valley(objective: Objective, free: tuple[bool, bool]) -> Points:
    """Return the starts of the search: the lowest minima of the best v of every u."""
    u = np.linspace(0, 1, _ACROSS) if free[0] else np.zeros(1)
    v, values = _best_across(objective, u, moves=free[1])
    starts = lowest_minima(values, _STARTS)
    slope = np.gradient(v, u) if free[0] else np.zeros(1)
    return Points(u[starts], v[starts], np.multiply(_STEP, free), slope[starts])


def refine(objective: Objective, start: Points) -> Points:
    """Search from every point on a 5 x 5 pattern that moves while it improves, else shrinks.

    The pattern is sheared along the valley, whose walls are kinks: a pattern across it would
    find every neighbor higher and stop halfway down.
    """
    offsets = start.step * _PATTERN
    u, v, scale = start.u.copy(), start.v.copy(), np.ones(len(start.u))
    for _ in range(_MAX_ROUNDS):
        rows = np.flatnonzero(scale * start.step.max() > TOLERANCE)
        if not len(rows):
            break
        moves = scale[rows, None, None] * offsets
        second_moves = moves[..., 1] + start.slope[rows, None] * moves[..., 0]
        tried_u = _onto_square(u[rows, None] + moves[..., 0])
        tried_v = _onto_square(v[rows, None] + second_moves)
        costs = objective(tried_u.ravel(), tried_v.ravel()).reshape(tried_u.shape)
        costs[:, 0] -= _LEAST_PROGRESS  # rounding noise must not count as progress
        best = np.argmin(costs, axis=1)
        u[rows], v[rows] = (trial[np.arange(len(rows)), best] for trial in (tried_u, tried_v))
        scale[rows] = np.where(best == 0, scale[rows] / 4, np.minimum(1, 2 * scale[rows]))
    return replace(start, u=u, v=v)


def _onto_square(w: FloatArray) -> FloatArray:
    """Clip to 0 to 1; for few numbers this takes half the time of `numpy.clip`."""
    return np.minimum(np.maximum(w, 0.0), 1.0)


def snap(
    objective: Objective, u: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Move points near an edge onto the edge where the cost stays; return costs too.

    An objective that is flat near an edge lets rounding hide the last step there.
    """
    edge_u, edge_v = (np.where(np.abs(w - np.round(w)) < 0.01, np.round(w), w) for w in (u, v))
    edges = ((edge_u, v), (u, edge_v), (edge_u, edge_v))
    tried_u, tried_v = (np.concatenate(tried) for tried in zip((u, v), *edges, strict=True))
    costs, *trials = objective(tried_u, tried_v).reshape(4, len(u))
    for (u_edge, v_edge), trial in zip(edges, trials, strict=True):
        gain = trial <= costs * (1 + 1e-12)
        u, v = np.where(gain, u_edge, u), np.where(gain, v_edge, v)
        costs = np.where(gain, trial, costs)
    return u, v, costs


def lowest_minima(values: FloatArray, count: int) -> NDArray[np.intp]:
    """Return the places of local minima, the lowest first, `most` at most."""
    padded = np.pad(values, 1, constant_values=np.inf)
    local = np.isfinite(values) & (values <= padded[:-2]) & (values <= padded[2:])
    places = np.flatnonzero(local)
    return places[np.argsort(values[places], kind="stable")][:count]


def _best_across(
    objective: Objective, u: FloatArray, *, moves: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the best v of every u, and the objective there."""
    if not moves:
        v = np.zeros(len(u))
        return v, objective(u, v)
    rows, tried = np.arange(len(u)), np.broadcast_to(np.linspace(0, 1, _COARSE), (len(u), _COARSE))
    spacing = 1 / (_COARSE - 1)
    for _ in range(_ROUNDS + 1):
        values = objective(np.repeat(u, tried.shape[1]), tried.ravel()).reshape(tried.shape)
        best = values.argmin(axis=1)
        v = tried[rows, best]
        tried = _onto_square(v[:, None] + spacing * np.linspace(-1, 1, _FINE))
        spacing *= 2 / (_FINE - 1)
    return v, values[rows, best]
