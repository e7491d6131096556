"""A primal-dual interior-point method for cones of one order, in plain numpy (untrusted).

Made for the search for a common quadratic function: all matrices have the same small order, there
is a strictly feasible start, and a good point is enough. So it ends after some ten steps where a
general solver goes for the optimum, and needs no solver to be loaded. Directions of Nesterov and
Todd with the predictor and corrector of Mehrotra (Toh, Todd, Tütüncü 1999; Vandenberghe 2010).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.sdp import pack, unpack
from nrs_design.work import Cost

Array = NDArray[np.float64]

MAX_STEPS = 60
# Share of the way to the border of the cones that a step goes.
STEP_SHARE = 0.95
# The optimum counts as found when X and Z are this close to complementary.
GAP_FLOOR = 1e-12
# The value is good enough where no other one can be larger by more than this factor.
GOOD_FACTOR = 2.0
# Work per step, per multiplication in it, and per entry of the images; and bytes per entry, with
# their copies.
PER_STEP = 3e-4
PER_PRODUCT = 2.2e-11
PER_ENTRY = 2.2e-8
BYTES_PER_ENTRY = 32


@dataclass(frozen=True, slots=True)
class Cones:
    """Matrices ``X_j(y) = constant_j + sum_k y_k images_jk`` that must be positive semidefinite."""

    constant: Array  # Shape (cones, n, n). Symmetric.
    images: Array  # Shape (variables, cones, n, n). Symmetric.

    def at(self, y: Array) -> Array:
        """Return all X_j, shape (cones, n, n)."""
        change = y @ self.images.reshape(len(y), -1)
        return self.constant + change.reshape(self.constant.shape)


def step_cost(variables: int, cones: int, order: int) -> Cost:
    """Predict what one step of `maximize_last` takes."""
    entries = variables * cones * order**2
    products = 2 * variables**2 * cones * order * (order + 1) / 2 + 4 * entries * order
    work = PER_STEP + PER_PRODUCT * products + PER_ENTRY * entries
    return Cost(work, BYTES_PER_ENTRY * entries)


def maximize_last(
    cones: Cones,
    start: Array,
    goes_on: Callable[[], bool] = lambda: True,
) -> Array:
    """Maximize the last variable, until it is positive and within a factor of the largest one.

    The start is strictly feasible; the matrices that the last variable enters grow as it falls.
    `goes_on` is asked before every step: No ends the search with the last iterate, strictly
    feasible in floating point.
    """
    inverse = np.linalg.inv(cones.at(start))
    # With this unit, Z = inverse satisfies the equation of the last variable at the start.
    Z = -inverse / (cones.images[-1] * inverse).sum()
    return follow(
        start,
        [Z],
        lambda y: [cones.at(y)],
        partial(_step, cones),
        lambda value, gap, lacks: gap <= max(GAP_FLOOR, (GOOD_FACTOR - 1) * value),
        goes_on,
    )


def follow(
    y: Array,
    Z: list[Array],
    at: Callable[[Array], list[Array]],
    step: Callable[[list[Array], list[Array]], tuple[Array, list[Array], float]],
    is_enough: Callable[[float, float, float], bool],
    goes_on: Callable[[], bool],
) -> Array:
    """Make steps until they are enough, and return the last unknowns.

    `at` gives X for unknowns; `step` the changes of y and Z, and by how much the equations of the
    optimum will fail. `is_enough` is asked with the last unknown, the gap, and that.
    """
    X = at(y)
    for _ in range(MAX_STEPS):
        if not goes_on():
            break
        try:
            dy, dZ, lacks = step(X, Z)
            trial, other = at(y + dy), [a + b for a, b in zip(Z, dZ, strict=True)]
        except np.linalg.LinAlgError:
            break
        if not all(np.isfinite(own).all() for own in (*trial, *other)):
            break
        y, X, Z = y + dy, trial, other
        gap = sum(float((a * b).sum()) for a, b in zip(X, Z, strict=True))
        if is_enough(float(y[-1]), gap, lacks):
            break
    return y


def _step(cones: Cones, Xs: list[Array], Zs: list[Array]) -> tuple[Array, list[Array], float]:
    """Return the changes of y and Z; zero, as nobody asks how far the equations fail."""
    (X,), (Z,) = Xs, Zs
    W, d = nesterov_todd(X, Z)
    back = np.swapaxes(W, -1, -2)
    # In the coordinates in which X and Z are the same diagonal matrix.
    rows = pack(W @ cones.images @ back).reshape(len(cones.images), -1)
    residual = cones.images.reshape(len(cones.images), -1) @ Z.ravel()
    residual[-1] += 1.0
    gram = rows @ rows.T

    def direction(target: list[Array]) -> tuple[Array, list[Array]]:
        force = rows @ pack(target[0]).ravel() + residual
        dy = np.asarray(np.linalg.solve(gram, force), dtype=np.float64)
        return dy, [unpack((dy @ rows).reshape(len(X), -1), X.shape[-1])]

    step = predict_and_correct([d], direction)
    return step.primal * step.dy, [step.dual * (back @ step.dZ[0] @ W)], 0.0


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
