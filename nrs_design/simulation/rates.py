"""How fast a quadratic function decreases in every mode, in floating point: for figures only."""

from __future__ import annotations

import numpy as np

from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.simulation.norms import Array


def mode_rates(system: SwitchedSystem, Q: Array) -> Array:
    """Return how fast ``sqrt(x' Q x)`` decays at least in every mode by itself, shape (m,).

    Continuous time: the largest alpha with ``A'Q + QA + 2 alpha Q <= 0``, in 1/s; negative where
    the norm can grow. Discrete time: the smallest rho with ``A'QA <= rho^2 Q``.
    """
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    largest = np.linalg.eigvalsh(inverse @ np.array(drift(system, Q)) @ inverse.T)[:, -1]
    if system.time is Time.DISCRETE:
        return np.asarray(np.sqrt(np.maximum(largest, 0.0)))
    return np.asarray(-largest / 2)


def drift(system: SwitchedSystem, Q: Array) -> list[Array]:
    """Return ``A'Q + QA`` (discrete time: ``A'QA``) of every mode."""
    matrices = [np.array(mode.A.floats()) for mode in system.modes]
    if system.time is Time.DISCRETE:
        return [A.T @ Q @ A for A in matrices]
    return [A.T @ Q + Q @ A for A in matrices]
