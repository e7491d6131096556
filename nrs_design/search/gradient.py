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
from nrs_design.search.acceptance import OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.balance import mean_norm, own_norms, round_coordinates
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.search.graphs import draw_balanced
from nrs_design.search.rates import at_own_rate, digits, position_of, rate_at
from nrs_design.work import Allowance, NotAffordableError

# Work per round and per multiplication in it.
PER_ROUND = 4e-5
PER_PRODUCT = 1e-8
# The largest v is told after so many updates each time, then whenever they have grown by a part.
TOLD_ONE_BY_ONE = 100
TOLD_GROWTH = 0.02
# Where the bisection for the largest rate ends: a share of the limit.
RATE_RESOLUTION = 1e-3
# Updates at each rate that it tries.
RATE_UPDATES = 2000

Matrices = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class GradientResult:
    """Outcome: Q, shape (n, n), or None, and the number of updates made."""

    Q: Matrices | None
    updates: int


def search_by_gradient(family: Family) -> Candidates[FormsOnGraph]:
    """Search for a common quadratic function; then, if asked to, raise its rate."""
    if not np.isfinite(family.limit):
        return OUT_OF_RANGE
    # The rungs below need time as well.
    family = replace(family, allowance=family.allowance.part(0.5))
    result = find_by_gradient(family)
    if result.Q is None:
        return f"not converged after {result.updates} updates"
    words = f"found after {result.updates} updates"
    if family.optimize_rate:
        faster = find_faster_by_gradient(family, result.Q)
        more = f"with a decay rate near the largest after {faster.updates} more"
        if faster.Q is not None:
            yield from _roundings(family, faster.Q, f"{words}, {more}")
    yield from _roundings(family, result.Q, words)
    return None


def _roundings(family: Family, Q: Matrices, words: str) -> Iterator[Candidate[FormsOnGraph]]:
    program = FormsProgram(draw_balanced(family))
    yield from at_own_rate(program, program.solution_of([Q]), family, digits(), words)


def find_by_gradient(family: Family) -> GradientResult:
    """Run the iteration in the coordinates of its settings; Q is for those of the family."""
    T = _coordinates(family, mean_norm(family.matrices, family.system.time))
    return _iterate_in(T, family, family.matrices, family.gradient)


def find_faster_by_gradient(family: Family, found: Matrices) -> GradientResult:
    """Bisect for the largest rate at which the iteration still ends; return its Q.

    Instead of mean-norm coordinates it takes those in which the best Q so far is round. It ends
    early when the work is used up; all updates that were made on the way are counted.
    """
    settings, time = family.gradient.briefly(RATE_UPDATES), family.system.time
    best, updates = found, 0
    low, high = _position(family, best), 1.0
    while high - low > RATE_RESOLUTION:
        middle = (low + high) / 2
        shifted = _shift(family.matrices, time, rate_at(middle, family.limit, time))
        T = _coordinates(family, best)
        try:
            result = _iterate_in(T, family, shifted, settings)
        except NotAffordableError:
            break
        updates += result.updates
        if result.Q is None:
            high = middle
        else:
            low, best = max(middle, _position(family, result.Q)), result.Q
    return GradientResult(best, updates)


def _iterate_in(
    T: Matrices, family: Family, matrices: Matrices, settings: Gradient
) -> GradientResult:
    """Iterate in z, ``x = T z``, and return Q for x."""
    inverse, names = np.linalg.inv(T), [mode.name for mode in family.system.modes]
    start = 0 if settings.start is None else names.index(settings.start)
    modes = inverse @ matrices @ T
    found = iterate_gradient(modes, family.system.time, settings, start, family.allowance)
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


def _shift(matrices: Matrices, time: Time, rate: float) -> Matrices:
    """Return modes that are stable where the given ones decay at a rate."""
    if time is Time.DISCRETE:
        return matrices / rate
    return np.asarray(matrices + rate * np.eye(matrices.shape[-1]))


def _coordinates(family: Family, norm: Matrices) -> Matrices:
    """Return T such that the iteration runs in z, ``x = T z``; in mean norm, `norm` is round."""
    wanted = family.gradient.coordinates
    if wanted == Coordinates.MEAN_NORM:
        return round_coordinates(norm)
    if wanted == Coordinates.GIVEN:
        return np.diag(np.ldexp(1.0, -family.exponents))
    return np.eye(len(norm))


def rate_of(matrices: Matrices, Q: Matrices, time: Time) -> float:
    """Return the best rate that a given Q shows, in 1/s or as the contraction per step."""
    T = round_coordinates(Q)
    modes = np.linalg.inv(T) @ matrices @ T
    if time is Time.DISCRETE:
        return float(np.linalg.norm(modes, 2, axis=(1, 2)).max())
    return -float(np.linalg.eigvalsh(modes + np.swapaxes(modes, 1, 2)).max()) / 2


def _position(family: Family, Q: Matrices) -> float:
    """Return where the rate that Q itself shows lies between mere stability and the limit."""
    time = family.system.time
    position = position_of(rate_of(family.matrices, Q, time), family.limit, time)
    return min(max(position, 0.0), 1.0)
