"""The gradient iteration of Liberzon and Tempo (2004), as a reference (untrusted search).

Thesis 5.21-5.28, with the update made iff v > 0 (the print says v > Theta). That it ends is no
evidence: its Q goes through the exact check like any other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.mode import Time
from nrs_design.search.acceptance import OUT_OF_RANGE, Candidates
from nrs_design.search.balance import mean_norm_coordinates, own_norms
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.search.graphs import draw_balanced
from nrs_design.search.rates import at_own_rate, digits
from nrs_design.work import Allowance

# Work per round and per multiplication in it.
PER_ROUND = 4e-5
PER_PRODUCT = 1e-8
# The largest v is told after so many updates each time, then whenever they have grown by a part.
TOLD_ONE_BY_ONE = 100
TOLD_GROWTH = 0.02

Matrices = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class GradientResult:
    """Outcome: Q, shape (n, n), or None, and the number of updates made."""

    Q: Matrices | None
    updates: int


def search_by_gradient(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a common quadratic function, and claim the rate that it shows itself."""
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    # The rungs below need time as well.
    result = find_by_gradient(replace(family, allowance=family.allowance.part(0.5)))
    if result.Q is None:
        return f"not converged after {result.updates} updates"
    program, words = FormsProgram(draw_balanced(family)), f"found after {result.updates} updates"
    yield from at_own_rate(program, program.solution_of([result.Q]), family, digits(), words)
    return None


def find_by_gradient(family: Family) -> GradientResult:
    """Iterate in the coordinates of the settings, ``x = T z``; Q is for x."""
    settings, time = family.gradient, family.system.time
    T, names = _coordinates(family), [mode.name for mode in family.system.modes]
    inverse, start = np.linalg.inv(T), 0 if settings.start is None else names.index(settings.start)
    modes = inverse @ family.matrices @ T
    found = iterate_gradient(modes, time, settings, start, family.allowance)
    return found if found.Q is None else replace(found, Q=inverse.T @ found.Q @ inverse)


def iterate_gradient(
    matrices: Matrices,
    time: Time,
    settings: Gradient,
    start: int = 0,
    allowance: Allowance | None = None,
) -> GradientResult:
    """Iterate ``Q+ = [Q - mu grad v(Q, A_i)]+`` over the modes until all have v <= 0.

    ``v(Q, A) = lambda_max(A'Q + QA + I)`` with the gradient ``A x x' + x x' A'``, x being the top
    eigenvector; in discrete time ``lambda_max(A'QA - Q + I)`` and ``A x x' A' - x x'``. The step is
    ``mu = (alpha v + r |grad|) / |grad|^2``. The first Q solves the Lyapunov equation of one stable
    mode, `start`. The coordinates are those of the matrices.
    """
    allowance, m = allowance or Allowance(), len(matrices)
    Q = own_norms(matrices[start, None], time)[0]
    order, fulfilled, updates = _order(m, settings), set[int](), 0
    teller = _Teller(settings, matrices, time)
    teller.tell(Q, updates)
    while len(fulfilled) < m and updates < settings.max_updates:
        allowance.charge(PER_ROUND + PER_PRODUCT * Q.size * len(Q))
        allowance.check()
        i = next(order)
        v, x = _worst(matrices[i], Q, time)
        if v <= 0:
            fulfilled.add(i)
            continue
        Q = _project(Q - _step(matrices[i], x, v, time, settings))
        updates += 1
        fulfilled.clear()
        teller.tell(Q, updates)
    teller.tell(Q, updates, last=True)
    return GradientResult(Q if len(fulfilled) == m else None, updates)


def _order(modes: int, settings: Gradient) -> Iterator[int]:
    """Yield which mode comes next."""
    rng, i = np.random.default_rng(settings.seed), -1
    while True:
        drawn = settings.order == Order.RANDOM
        i = int(rng.integers(modes)) if drawn else (i + 1) % modes
        yield i


def _excess(A: Matrices, Q: Matrices, time: Time) -> Matrices:
    """Return what must be negative semidefinite; A may be a stack."""
    if time is Time.DISCRETE:
        return np.asarray(np.swapaxes(A, -1, -2) @ Q @ A - Q + np.eye(len(Q)))
    half = Q @ A
    return np.asarray(half + np.swapaxes(half, -1, -2) + np.eye(len(Q)))


def _worst(A: Matrices, Q: Matrices, time: Time) -> tuple[float, Matrices]:
    values, vectors = np.linalg.eigh(_excess(A, Q, time))
    return float(values[-1]), vectors[:, -1]


def _step(A: Matrices, x: Matrices, v: float, time: Time, settings: Gradient) -> Matrices:
    image = A @ x
    if time is Time.DISCRETE:
        gradient = np.outer(image, image) - np.outer(x, x)
    else:
        gradient = np.outer(image, x) + np.outer(x, image)
    norm = float(np.linalg.norm(gradient))
    return (settings.relaxation * v + settings.radius * norm) / norm**2 * gradient


def _project(Q: Matrices) -> Matrices:
    """Project onto the cone of positive semidefinite matrices."""
    values, vectors = np.linalg.eigh((Q + Q.T) / 2)
    projected: Matrices = (vectors * np.maximum(values, 0.0)) @ vectors.T
    return projected


class _Teller:
    """Tells whoever listens how large v is over all modes, the longer the more rarely."""

    def __init__(self, settings: Gradient, matrices: Matrices, time: Time) -> None:
        self._settings, self._matrices, self._time = settings, matrices, time
        self._next, self._told = 0, -1

    def tell(self, Q: Matrices, updates: int, *, last: bool = False) -> None:
        """Tell it if it is due, and at the end in any case, but once."""
        due = updates >= self._next or (last and updates != self._told)
        if not (self._settings.is_told and due):
            return
        self._told = updates
        self._next = updates + 1 + int(TOLD_GROWTH * max(updates - TOLD_ONE_BY_ONE, 0))
        excess = np.linalg.eigvalsh(_excess(self._matrices, Q, self._time))[:, -1]
        self._settings.tell(updates, float(excess.max()))


def _coordinates(family: Family) -> Matrices:
    """Return T such that the iteration runs in z, ``x = T z``."""
    wanted = family.gradient.coordinates
    if wanted == Coordinates.MEAN_NORM:
        return mean_norm_coordinates(family.matrices, family.system.time)
    if wanted == Coordinates.GIVEN:
        return np.diag(np.ldexp(1.0, -family.exponents))
    return np.eye(len(family.exponents))
