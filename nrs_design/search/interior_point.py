"""A primal-dual interior-point method for quadratic forms on a graph (untrusted).

A general solver is given an inequality as that many linear equations as it has entries, and
factors them all; it has to be loaded, and goes for the optimum. Here blocks in which the same
unknowns enter are handled at once, what is left to solve are the equations of the unknowns alone,
and a good point is enough. For 20 states and some thirty modes that takes a tenth of the time.

Directions of Nesterov and Todd with the predictor and corrector of Mehrotra (Toh, Todd, Tütüncü
1999; Vandenberghe 2010).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]

MAX_STEPS = 60
# Share of the way to the border of the cones that a step goes.
STEP_SHARE = 0.95
# Relative accuracy of the last unknown. Without a positive value, the last unknown is zero if
# the dual bound is at most NIL, or below NEARLY_NIL at the end of the iteration.
ACCURACY, NIL, NEARLY_NIL = 0.5, 1e-11, 1e-8
# The equations of the optimum hold nearly enough for its bound to be believed.
NEARLY_DUAL = 1e-6
# Fewest steps that the budget must allow. The start is below the margin of the first unknowns by
# at least START_FLOOR, or, if smaller, by WARM times the initial last unknown.
FEWEST_STEPS, START_FLOOR, WARM = 4, 1e-3, 100.0
# Work per step, per group of blocks and per multiplication; bytes per entry.
PER_STEP, PER_GROUP, PER_PRODUCT, BYTES_PER_ENTRY = 2e-4, 3e-4, 1e-10, 32


@dataclass(frozen=True)
class ConeGroup:
    """Blocks of one size in which the same unknowns enter: ``X = C + sum of y_k F_k``."""

    unknowns: NDArray[np.int64]
    constants: Array  # Shape (b, s, s)
    forms: Array  # Shape (b, k, s, s)

    def at(self, y: Array) -> Array:
        """Return all X."""
        return np.asarray(self.constants + np.tensordot(self.forms, y[self.unknowns], (1, 0)))


def step_cost(groups: Sequence[ConeGroup], unknowns: int) -> Cost:
    """Predict what a step takes."""
    entries = [(group.forms.size, *group.forms.shape[1:3]) for group in groups]
    products = unknowns**3 / 3 + sum(size * (2 * s + k) for size, k, s in entries)
    work = PER_STEP + PER_GROUP * len(groups) + PER_PRODUCT * products
    return Cost(work, BYTES_PER_ENTRY * sum(size for size, *_ in entries))


def maximize(groups: Sequence[ConeGroup], start: Array, allowance: Allowance) -> Array | None:
    """Make the last unknown positive, and large up to a share of itself.

    It is taken from the diagonals of some blocks, of which the start leaves something, perhaps so
    much as it says, and nothing else is negative there. None if floating point did not suffice to
    tell whether it can be positive.
    """
    step, y, margin = step_cost(groups, len(start)), start.copy(), start[-1]
    description = (
        f"a program of {len(y)} unknowns and {sum(len(X.constants) for X in groups)} blocks"
    )
    allowance.require(Cost(FEWEST_STEPS * step.work, step.memory), description)
    y[-1] = 0.0
    counting = [group.at(y) for group in groups if group.unknowns[-1] == len(y) - 1]
    smallest = min(float(np.linalg.eigvalsh(X)[:, 0].min()) for X in counting)
    distance = max(0.1 * max(float(np.abs(X).max()) for X in counting), START_FLOOR)
    y[-1] = smallest - (min(distance, WARM * margin) if margin > 0 else distance)
    X, bound = [group.at(y) for group in groups], np.inf
    Z = [np.asarray(np.linalg.inv(block)) for block in X]
    dual_sum = -_adjoint(groups, Z, len(y))[-1]
    Z = [own / dual_sum for own in Z]
    for _ in range(MAX_STEPS):
        if not allowance.goes_on(step.work):
            return y
        try:
            dy, dZ, lacks = _step(groups, X, Z, len(y))
        except np.linalg.LinAlgError:
            break
        y, Z = y + dy, [a + b for a, b in zip(Z, dZ, strict=True)]
        X = [group.at(y) for group in groups]
        if not all(np.isfinite(own).all() for own in (*X, *Z)):
            break
        gap = sum(float((a * b).sum()) for a, b in zip(X, Z, strict=True))
        if lacks < NEARLY_DUAL:
            bound = y[-1] + gap
        if bound <= NIL or (y[-1] > 0 and gap <= ACCURACY * y[-1]):
            return y
    return y if bound < NEARLY_NIL else None


def _adjoint(groups: Sequence[ConeGroup], Z: list[Array], count: int) -> Array:
    """Return the product of every unknown's forms with matrices."""
    result = np.zeros(count)
    for group, own in zip(groups, Z, strict=True):
        result[group.unknowns] += np.einsum("bkij,bij->k", group.forms, own)
    return result


def _step(
    groups: Sequence[ConeGroup], X: list[Array], Z: list[Array], count: int
) -> tuple[Array, list[Array], float]:
    """Return the changes of y and Z, and by how much the equations of the optimum will fail.

    Predictor and corrector, in coordinates in which X and Z are diagonal with the entries d.
    """
    W, d, scaled = list[Array](), list[Array](), list[Array]()
    residual, gram = _adjoint(groups, Z, count), np.zeros((count, count))
    residual[-1] += 1.0
    for group, own, dual in zip(groups, X, Z, strict=True):
        L, R = np.linalg.cholesky(own), np.linalg.cholesky((dual + _transposed(dual)) / 2)
        _, entries, Vt = np.linalg.svd(_transposed(R) @ L)
        # X as ``scale X scale'``, and Z by the inverse.
        scale = np.sqrt(entries)[..., None] * Vt @ np.linalg.inv(L)
        scaled_forms = scale[:, None] @ group.forms @ _transposed(scale)[:, None]
        scaled_forms = np.swapaxes(scaled_forms, 0, 1).reshape(len(group.unknowns), -1)
        gram[np.ix_(group.unknowns, group.unknowns)] += scaled_forms @ scaled_forms.T
        W.append(scale)
        d.append(entries)
        scaled.append(scaled_forms)
    inverse = np.linalg.inv(np.linalg.cholesky(gram))

    def direction(target: list[Array]) -> tuple[Array, list[Array], list[Array]]:
        """Return the changes of y, X and Z; those of X and Z add up to the target."""
        force = residual.copy()
        for group, scaled_forms, part in zip(groups, scaled, target, strict=True):
            force[group.unknowns] += scaled_forms @ part.ravel()
        dy = inverse.T @ (inverse @ force)
        dX = [
            (dy[group.unknowns] @ moved).reshape(part.shape)
            for group, moved, part in zip(groups, scaled, target, strict=True)
        ]
        return dy, dX, [a - b for a, b in zip(target, dX, strict=True)]

    D = [own[..., None] * np.eye(own.shape[-1]) for own in d]
    _, dX, dZ = direction([-own for own in D])
    first, second = _farthest(d, dX, 1.0), _farthest(d, dZ, 1.0)
    gap, size = sum(float((own * own).sum()) for own in d), sum(own.size for own in d)
    predicted_gap = sum(
        float(((a + first * b) * (a + second * c)).sum()) for a, b, c in zip(D, dX, dZ, strict=True)
    )
    center = max(predicted_gap / gap, 0.0) ** 3 * gap / size
    target = [
        center / own[..., None] * np.eye(own.shape[-1])
        - (b @ c + c @ b) / (own[..., None] + own[..., None, :])
        - a
        for own, a, b, c in zip(d, D, dX, dZ, strict=True)
    ]
    dy, dX, dZ = direction(target)
    primal, dual_step = _farthest(d, dX, STEP_SHARE), _farthest(d, dZ, STEP_SHARE)
    lacks = (1 - dual_step) * float(np.abs(residual).max())
    dZ = [dual_step * (_transposed(own) @ part @ own) for own, part in zip(W, dZ, strict=True)]
    return primal * dy, dZ, lacks


def _farthest(d: list[Array], change: list[Array], share: float) -> float:
    """Return the length of a step, at most one, as a share of the way to the border."""
    steepest = share
    for own, part in zip(d, change, strict=True):
        root = np.sqrt(own)
        relative = part / (root[..., None] * root[..., None, :])
        steepest = max(steepest, float(-np.linalg.eigvalsh(relative)[..., 0].min()))
    return share / steepest


def _transposed(A: NDArray[np.floating]) -> Array:
    return np.asarray(np.swapaxes(A, -1, -2), dtype=float)
