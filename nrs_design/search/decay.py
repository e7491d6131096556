"""Decay rates that modes allow, and that a quadratic function shows (untrusted)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.search.lmi import decreases


def limit_rate(matrices: NDArray[np.float64], time: Time) -> float:
    """Return the rate of the slowest mode: ``-max Re`` in 1/s, or the largest spectral radius.

    Not a number if the matrices are beyond the range of floating point.
    """
    if not np.isfinite(matrices).all():
        return np.nan
    eigenvalues = np.linalg.eigvals(matrices)
    if time is Time.CONTINUOUS:
        return float(-eigenvalues.real.max())
    return float(np.abs(eigenvalues).max())


def rate_of(matrices: NDArray[np.float64], Q: NDArray[np.float64], time: Time) -> float:
    """Return the best rate that a given Q shows, by generalized eigenvalues.

    In 1/s; in discrete time, the contraction per step.
    """
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    forms = inverse @ decreases(matrices, Q, time, 0.0) @ inverse.T
    values = np.linalg.eigvalsh(forms)
    if time is Time.CONTINUOUS:
        return float(values[:, 0].min()) / 2
    return float(np.sqrt(max(-values[:, 0].min(), 0.0)))
