"""The gradient iteration of Liberzon and Tempo (2004), as a reference (untrusted search).

Thesis 5.21-5.28, with the update made iff v > 0 (the print says v > Theta).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.search.allowance import Allowance
from nrs_design.certificates.search.balance import own_norm
from nrs_design.switched.system import Time

RELAXATION = 1.0
RADIUS = 1e-2
# Seconds per round and per multiplication in it.
PER_ROUND = 2e-5
PER_PRODUCT = 1e-8


@dataclass(frozen=True, slots=True)
class GradientResult:
    """Outcome: Q, shape (n, n), or None, and the number of updates made."""

    Q: NDArray[np.float64] | None
    updates: int


def iterate_gradient(
    matrices: NDArray[np.float64],
    rate: float = 0.0,
    max_updates: int = 20_000,
    allowance: Allowance | None = None,
) -> GradientResult:
    """Iterate ``Q+ = [Q - mu grad v(Q, A_i)]+`` over the modes in turn until all have v <= 0.

    ``v(Q, A) = lambda_max(A'Q + QA + Theta)`` with ``Theta = I``, its gradient
    ``A x x' + x x' A'`` with x the top eigenvector, and the step
    ``mu = (alpha v + r |grad|) / |grad|^2``. Starts from the Lyapunov equation of the first mode.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        Hurwitz modes in continuous time, preferably balanced.
    rate : float
        The modes are shifted by this rate, in 1/s.
    max_updates : int
        Updates after which the search gives up.
    allowance : Allowance, optional
        Time; unlimited by default.

    Raises
    ------
    NotAffordableError
        If the time is over.
    """
    allowance = allowance or Allowance()
    m, n = matrices.shape[:2]
    theta = np.eye(n)
    shifted = matrices + rate * theta
    Q = own_norm(shifted[0], Time.CONTINUOUS)
    quiet = updates = i = 0
    while quiet < m and updates < max_updates:
        allowance.charge(PER_ROUND + PER_PRODUCT * n**3)
        allowance.check()
        A = shifted[i]
        values, vectors = np.linalg.eigh(A.T @ Q + Q @ A + theta)
        if values[-1] > 0:
            Q = _project(Q - _step(A, vectors[:, -1], values[-1]))
            quiet, updates = 0, updates + 1
        else:
            quiet += 1
        i = (i + 1) % m
    return GradientResult(Q if quiet == m else None, updates)


def _step(A: NDArray[np.float64], x: NDArray[np.float64], v: float) -> NDArray[np.float64]:
    half = np.outer(A @ x, x)
    gradient = half + half.T
    norm = float(np.linalg.norm(gradient))
    return (RELAXATION * v + RADIUS * norm) / norm**2 * gradient


def _project(Q: NDArray[np.float64]) -> NDArray[np.float64]:
    """Project onto the cone of positive semidefinite matrices."""
    values, vectors = np.linalg.eigh((Q + Q.T) / 2)
    projected: NDArray[np.float64] = (vectors * np.maximum(values, 0.0)) @ vectors.T
    return projected
