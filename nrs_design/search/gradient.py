"""Gradient iteration of Liberzon and Tempo (2004), as a reference (untrusted search).

Thesis 5.21-5.28, with an update iff v > 0 (the print says v > Theta). The end of the iteration is
no evidence: the exact check decides about its Q as about any other.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.mode import Time
from nrs_design.search.acceptance import OUT_OF_RANGE, Candidates
from nrs_design.search.balance import mean_norm, own_norms, round_coordinates
from nrs_design.search.family import Family
from nrs_design.search.forms import FormsProgram
from nrs_design.search.graphs import draw_balanced
from nrs_design.search.rates import at_own_rate, digits
from nrs_design.search.work import Allowance

# Work per round and per multiplication in it.
PER_ROUND = 4e-5
PER_PRODUCT = 1e-8

Matrices = NDArray[np.float64]


class Coordinates(StrEnum):
    """States of the iteration; they decide how fast it ends, or whether."""

    MEAN_NORM = "mean-norm"  # The mean of the norms of the modes is the identity
    BALANCED = "balanced"  # By powers of two
    GIVEN = "given"  # Coordinates of the modes, as in the thesis


class Order(StrEnum):
    """Order of the modes."""

    ROUND_ROBIN = "round-robin"  # As in 5.26
    RANDOM = "random"


@dataclass(frozen=True, slots=True)
class Gradient:
    """Settings of the iteration."""

    relaxation: float = 1.0  # The alpha of 5.25, from 0 to 2
    radius: float = 1.0  # The r of 5.25, above 0: the shortest step, in the norm of Frobenius
    order: Order = Order.ROUND_ROBIN
    max_updates: int = 20_000
    coordinates: Coordinates = Coordinates.MEAN_NORM
    start: int = 0  # Index of the mode whose Lyapunov equation gives the first Q


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
    result = find_by_gradient(replace(family, allowance=family.allowance.part(0.5)), Gradient())
    if result.Q is None:
        return f"not converged after {result.updates} updates"
    program, words = FormsProgram(draw_balanced(family)), f"found after {result.updates} updates"
    yield from at_own_rate(program, program.solution_of([result.Q]), family, digits(), words)
    return None


def find_by_gradient(family: Family, settings: Gradient) -> GradientResult:
    """Iterate in the coordinates of the settings, ``x = T z``; Q is for x."""
    T, time = _coordinates(family, settings.coordinates), family.system.time
    inverse = np.linalg.inv(T)
    found = iterate_gradient(inverse @ family.matrices @ T, time, settings, family.allowance)
    return found if found.Q is None else replace(found, Q=inverse.T @ found.Q @ inverse)


def iterate_gradient(
    matrices: Matrices, time: Time, settings: Gradient, allowance: Allowance
) -> GradientResult:
    """Iterate ``Q+ = [Q - mu grad v(Q, A_i)]+`` over the modes until all have v <= 0.

    ``v(Q, A) = lambda_max(A'Q + QA + I)`` with the gradient ``A x x' + x x' A'``, x being the top
    eigenvector; in discrete time ``lambda_max(A'QA - Q + I)`` and ``A x x' A' - x x'``. The step is
    ``mu = (alpha v + r |grad|) / |grad|^2``. The coordinates are those of the matrices.
    """
    Q = own_norms(matrices[settings.start, None], time)[0]
    order, fulfilled, updates = _order(len(matrices), settings), set[int](), 0
    while len(fulfilled) < len(matrices):
        if updates == settings.max_updates:
            return GradientResult(None, updates)
        allowance.charge(PER_ROUND + PER_PRODUCT * Q.size * len(Q))
        allowance.check()
        i = next(order)
        values, vectors = np.linalg.eigh(_excess(matrices[i], Q, time))
        if values[-1] <= 0:
            fulfilled.add(i)
            continue
        Q = _project(Q - _step(matrices[i], vectors[:, -1], float(values[-1]), time, settings))
        updates += 1
        fulfilled.clear()
    return GradientResult(Q, updates)


def _order(modes: int, settings: Gradient) -> Iterator[int]:
    """Yield the index of each next mode."""
    rng, i = np.random.default_rng(0), -1
    while True:
        i = int(rng.integers(modes)) if settings.order == Order.RANDOM else (i + 1) % modes
        yield i


def _excess(A: Matrices, Q: Matrices, time: Time) -> Matrices:
    """Return the form that must be negative semidefinite."""
    if time is Time.DISCRETE:
        return np.asarray(A.T @ Q @ A - Q + np.eye(len(Q)))
    half = Q @ A
    return np.asarray(half + half.T + np.eye(len(Q)))


def _step(A: Matrices, x: Matrices, v: float, time: Time, settings: Gradient) -> Matrices:
    """Return the step of Q for the top eigenvalue v of the excess, and its eigenvector."""
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
    return np.asarray((vectors * np.maximum(values, 0.0)) @ vectors.T)


def _coordinates(family: Family, coordinates: Coordinates) -> Matrices:
    """Return T such that the iteration runs in z, ``x = T z``."""
    if coordinates is Coordinates.MEAN_NORM:
        return round_coordinates(mean_norm(family.matrices, family.system.time))
    if coordinates is Coordinates.GIVEN:
        return np.diag(np.ldexp(1.0, -family.exponents))
    return np.eye(len(family.exponents))
