"""A primal-dual interior-point method for quadratic forms on a graph (untrusted).

A general solver is given the inequality of an edge as that many linear equations as it has
entries, and factors them all; it has to be loaded, and goes for the optimum. Here the matrices of
the second derivative are sums of Kronecker products, which one multiplication of matrices makes for
all edges of a kind at once, what is left to solve are the equations of the forms alone, and a good
point is enough. For 15 states and some sixty edges that takes a twentieth of the time.

The forms have a fixed trace, so the margin has a sign: where it is negative, the forms are those
that come nearest. Directions of Nesterov and Todd with the predictor and corrector of Mehrotra
(Toh, Todd, Tütüncü 1999; Vandenberghe 2010).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.cones import FormsCones, transposed
from nrs_design.search.sdp import pack

Array = NDArray[np.float64]

MAX_STEPS = 60
# Share of the way to the border of the cones that a step goes.
STEP_SHARE = 0.95
# The margin is found to this share of itself, or to this share of the forms where it is nil.
ACCURACY, FLOOR = 0.5, 1e-11
# The equations of the optimum hold nearly enough for its bound to be believed.
NEARLY_DUAL = 1e-6
# The start lies below the margin of its forms by at least this, and its multipliers are these.
START_FLOOR, START_MULTIPLIER = 1e-3, 0.1
# What was found for other numbers starts so many of its margins below.
WARM = 100.0


@dataclass(frozen=True)
class FormsPoint:
    """Forms and multipliers, with the margin that they leave."""

    forms: list[Array]
    multipliers: Array
    margin: float  # Negative if some inequality does not hold


def maximize(
    cones: FormsCones,
    start: FormsPoint | None,
    goes_on: Callable[[], bool] = lambda: True,
    accuracy: float = ACCURACY,
) -> FormsPoint:
    """Maximize the margin, to a share of itself; end where it is found to be negative, too.

    It starts at positive definite forms and multipliers, else at the identity. `goes_on` is asked
    before every step; No ends the search with the last iterate.
    """
    y = _start(cones, start)
    X = cones.at(y)
    inverse = [np.asarray(np.linalg.inv(own), dtype=np.float64) for own in X]
    counted = sum(
        float(np.trace(own, axis1=1, axis2=2).sum())
        for own, kind in zip(inverse, cones.kinds, strict=True)
        if kind.counts
    )
    Z = [own / counted for own in inverse]
    for _ in range(MAX_STEPS):
        if not goes_on():
            break
        try:
            dy, dZ, lacks = _step(cones, X, Z)
            trial, other = cones.at(y + dy), [a + b for a, b in zip(Z, dZ, strict=True)]
        except np.linalg.LinAlgError:
            break
        if not all(np.isfinite(own).all() for own in (*trial, *other)):
            break
        y, X, Z = y + dy, trial, other
        value, gap = float(y[-1]), sum(float((a * b).sum()) for a, b in zip(X, Z, strict=True))
        if value > 0 and gap <= accuracy * value:
            break
        if lacks < NEARLY_DUAL and (gap <= max(FLOOR, -accuracy * value) or value + 2 * gap < 0):
            break
    forms, multipliers = cones.split(y)
    return FormsPoint(forms, multipliers, float(y[-1]))


def _start(cones: FormsCones, start: FormsPoint | None) -> Array:
    count = cones.unknowns - int(cones.ends[-1]) - 1
    if start is None:
        forms = [np.eye(n) for n in cones.sizes]
        start = FormsPoint(forms, np.full(count, START_MULTIPLIER), 0.0)
    whole = sum(float(np.trace(Q)) for Q in start.forms)
    share = sum(cones.sizes) / whole
    packed = [pack(share * Q) for Q in start.forms]
    y = np.concatenate([*packed, share * start.multipliers, [0.0]])
    counting = [X for X, kind in zip(cones.at(y), cones.kinds, strict=True) if kind.counts]
    least = min(float(np.linalg.eigvalsh(X)[:, 0].min()) for X in counting)
    largest = max(float(np.abs(X).max()) for X in counting)
    below = max(0.1 * largest, START_FLOOR)
    y[-1] = least - (min(below, WARM * abs(start.margin)) if start.margin else below)
    return y


def _step(cones: FormsCones, X: list[Array], Z: list[Array]) -> tuple[Array, list[Array], float]:
    """Return the changes of y and Z, and by how much the equations of the optimum will fail."""
    scaled = [nesterov_todd(a, b) for a, b in zip(X, Z, strict=True)]
    W, d = [own[0] for own in scaled], [own[1] for own in scaled]
    residual = cones.adjoint(Z)
    residual[-1] += 1.0
    gram = np.zeros((cones.unknowns + 1, cones.unknowns + 1))
    gram[:-1, :-1] = cones.gram([transposed(own) @ own for own in W])
    # The trace does not change; its unit is that of the other equations.
    size = float(np.sqrt(np.abs(gram.diagonal()[:-1]).max()))
    gram[-1, :-1] = gram[:-1, -1] = size * cones.trace

    def direction(target: list[Array]) -> tuple[Array, list[Array]]:
        moved = [transposed(own) @ part @ own for own, part in zip(W, target, strict=True)]
        force = np.append(cones.adjoint(moved) + residual, 0.0)
        dy = np.asarray(np.linalg.solve(gram, force))[:-1]
        return dy, [
            own @ part @ transposed(own) for own, part in zip(W, cones.image(dy), strict=True)
        ]

    step = predict_and_correct(d, direction)
    # The equation of the trace makes up for a part of the residual.
    along = cones.trace * float(residual @ cones.trace) / float(cones.trace @ cones.trace)
    lacks = (1 - step.dual) * float(np.abs(residual - along).max())
    back = [
        step.dual * (transposed(own) @ part @ own) for own, part in zip(W, step.dZ, strict=True)
    ]
    return step.primal * step.dy, back, lacks


class ScaledStep(NamedTuple):
    """A direction in scaled coordinates, and how far X and Z may follow it."""

    dy: Array
    dZ: list[Array]
    primal: float
    dual: float


def predict_and_correct(
    d: list[Array], direction: Callable[[list[Array]], tuple[Array, list[Array]]]
) -> ScaledStep:
    """Return the step of Mehrotra, from where X and Z are diagonal with the entries d.

    The direction gives the changes of y and X for what those of X and Z are to add up to.
    """
    D = [own[..., None] * np.eye(own.shape[-1]) for own in d]
    target = [-own for own in D]
    _, dX = direction(target)
    dZ = [a - b for a, b in zip(target, dX, strict=True)]
    gap, count = sum(float((own * own).sum()) for own in d), sum(own.size for own in d)
    first, second = _farthest(d, dX, 1.0), _farthest(d, dZ, 1.0)
    reached = sum(
        float(((a + first * b) * (a + second * c)).sum()) for a, b, c in zip(D, dX, dZ, strict=True)
    )
    center = max(reached / gap, 0.0) ** 3 * gap / count
    target = [
        center / own[..., None] * np.eye(own.shape[-1])
        - (b @ c + c @ b) / (own[..., None] + own[..., None, :])
        - a
        for own, a, b, c in zip(d, D, dX, dZ, strict=True)
    ]
    dy, dX = direction(target)
    dZ = [a - b for a, b in zip(target, dX, strict=True)]
    return ScaledStep(dy, dZ, _farthest(d, dX, STEP_SHARE), _farthest(d, dZ, STEP_SHARE))


def nesterov_todd(X: Array, Z: Array) -> tuple[Array, Array]:
    """Return W with ``W X W' = W^-T Z W^-1`` diagonal, and the diagonals.

    A LinAlgError if X or Z, shape (cones, n, n), is not positive definite in floating point.
    """
    L = np.linalg.cholesky(X)
    R = np.linalg.cholesky((Z + np.swapaxes(Z, -1, -2)) / 2)
    _, d, Vt = np.linalg.svd(np.swapaxes(R, -1, -2) @ L)
    return np.sqrt(d)[..., None] * Vt @ np.linalg.inv(L), d


def _farthest(d: list[Array], change: list[Array], share: float) -> float:
    """Return how far a step may go, one at most, as a share of the way to the border."""
    return min(_to_border(own, part, share) for own, part in zip(d, change, strict=True))


def _to_border(d: Array, change: Array, share: float) -> float:
    root = np.sqrt(d)
    relative = change / (root[..., None] * root[..., None, :])
    steepest = float(-np.linalg.eigvalsh(relative)[..., 0].min())
    return 1.0 if steepest <= share else share / steepest
