"""The largest decay rate that a common quadratic function shows (untrusted search).

A position s in [0, 1) stands for the rate: 0 is mere stability, 1 the rate of the slowest mode,
which no common function can exceed.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.system import Time
from nrs_design.search.allowance import Allowance, NotAffordableError
from nrs_design.search.lmi import decreases, find_common_quadratic

TOLERANCE = 1e-4
# A position is bracketed to this share of itself, or given up below the smallest one.
RESOLUTION = 2.0**-12
SMALLEST = 2.0**-40


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


def rate_at(position: float, limit: float, time: Time) -> float:
    """Return the rate at a position between mere stability and the limit.

    Parameters
    ----------
    position : float
        From 0, mere stability, to 1, the limit.
    limit : float
        The alpha in 1/s, or rho per step, that no proof can beat.
    time : Time
        Which of the two.
    """
    return position * limit if time is Time.CONTINUOUS else 1 - position * (1 - limit)


def largest_position(
    matrices: NDArray[np.float64], time: Time, limit: float, allowance: Allowance | None = None
) -> float:
    """Bisect for the largest position at which the search still finds a function.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        Balanced modes with a common quadratic function.
    time : Time
        Continuous or discrete.
    limit : float
        As `limit_rate` gives it.
    allowance : Allowance, optional
        When it is used up, the bisection ends early.
    """
    low, high = 0.0, 1.0
    while high - low > TOLERANCE:
        middle = (low + high) / 2
        rate = rate_at(middle, limit, time)
        try:
            found = find_common_quadratic(matrices, time, rate, allowance=allowance)
        except NotAffordableError:
            break
        low, high = (low, middle) if found is None else (middle, high)
    return low


def bisect_position(is_feasible: Callable[[float], bool]) -> float:
    """Bisect for the largest feasible position, however near to mere stability it is.

    When what the search may take is used up, the bisection ends early.

    Returns
    -------
    float
        Zero if nothing above the smallest position is feasible.
    """
    low, high = 0.0, 1.0
    while high > SMALLEST and high - low > RESOLUTION * high:
        middle = (low + high) / 2
        try:
            low, high = (middle, high) if is_feasible(middle) else (low, middle)
        except NotAffordableError:
            break
    return low


def rate_of(matrices: NDArray[np.float64], Q: NDArray[np.float64], time: Time) -> float:
    """Return the best rate that a given Q shows, by generalized eigenvalues.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        Modes.
    Q : ndarray, shape (n, n)
        Positive definite.
    time : Time
        Continuous (in 1/s) or discrete (contraction per step).
    """
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    forms = inverse @ decreases(matrices, Q, time, 0.0) @ inverse.T
    values = np.linalg.eigvalsh(forms)
    if time is Time.CONTINUOUS:
        return float(values[:, 0].min()) / 2
    return float(np.sqrt(max(-values[:, 0].min(), 0.0)))
