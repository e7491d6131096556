"""Search for a common quadratic Lyapunov function by semidefinite programming (untrusted).

Margin form: maximize t subject to ``0 <= Q <= I`` and a decrease of at least t in every mode.
Only the modes that the last candidate violates enter the solver. A solver's status is never
evidence: whatever it returns goes through the exact check.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.search.sdp import maximize_margin, pack, symmetric_basis
from nrs_design.switched.system import Time

Matrices = NDArray[np.float64]

# Below so many cone rows one solve with all modes is faster than adding modes lazily.
ALL_AT_ONCE_ROWS = 6000
FIRST_MODES = 8
# A probe with the first modes alone is worth its time where it is a small share of all of them.
PROBE_BELOW_SHARE = 8
MARGIN_FLOOR = 1e-10
# In continuous time, the unit of time is chosen so that the largest entry is just below 2^3.
ENTRY_LOG2 = 3


def decreases(matrices: Matrices, Q: NDArray[np.float64], time: Time, rate: float) -> Matrices:
    """Return, for every mode, the matrix that must be positive definite; shape (m, n, n)."""
    if time is Time.CONTINUOUS:
        half = Q @ matrices
        return -(half + np.swapaxes(half, -1, -2)) - 2 * rate * Q
    return rate**2 * Q - np.swapaxes(matrices, -1, -2) @ Q @ matrices


def margins(matrices: Matrices, Q: NDArray[np.float64], time: Time, rate: float) -> Matrices:
    """Return the smallest eigenvalue of every mode's decrease; shape (m,)."""
    return np.asarray(np.linalg.eigvalsh(decreases(matrices, Q, time, rate))[:, 0], dtype=float)


def find_common_quadratic(
    matrices: Matrices, time: Time, rate: float
) -> NDArray[np.float64] | None:
    """Look for Q with ``A'Q + QA + 2 rate Q < 0`` (or ``A'QA < rate^2 Q``) for all modes.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        Modes, preferably balanced.
    time : Time
        Continuous or discrete.
    rate : float
        Decay rate in 1/s, or contraction per step.

    Returns
    -------
    ndarray, shape (n, n), or None
        A candidate with positive margins in floating point, or None.
    """
    unit = time_unit(matrices, time)
    matrices, rate = np.ldexp(matrices, unit), float(np.ldexp(rate, unit))
    m, n = matrices.shape[:2]
    few_rows = m * n * (n + 1) // 2 <= ALL_AT_ONCE_ROWS
    probing = not few_rows or m >= PROBE_BELOW_SHARE * FIRST_MODES
    active = np.linspace(0, m - 1, FIRST_MODES).astype(int) if probing else np.arange(m)
    while True:
        Q = _solve(matrices[active], time, rate)
        if Q is None or not np.isfinite(decreases(matrices, Q, time, rate)).all():
            return None
        margin = margins(matrices, Q, time, rate)
        if margin.min() > 0:
            return Q
        if margin[active].min() <= MARGIN_FLOOR:
            return None
        if few_rows:
            active = np.arange(m)
            continue
        violated = np.setdiff1d(np.flatnonzero(margin <= 0), active)
        worst = violated[np.argsort(margin[violated])][: len(active)]
        active = np.sort(np.concatenate([active, worst]))


def time_unit(matrices: Matrices, time: Time) -> int:
    """Choose the unit of time, two to this power, by the largest entry; Q does not depend on it."""
    if time is Time.DISCRETE:
        return 0
    return ENTRY_LOG2 - int(np.frexp(np.abs(matrices).max())[1])


def _solve(matrices: Matrices, time: Time, rate: float) -> NDArray[np.float64] | None:
    """Solve the margin form for the given modes; None if the result is not finite."""
    m, n = matrices.shape[:2]
    basis, identity = symmetric_basis(n), pack(np.eye(n))
    size = len(basis)
    images = np.stack([decreases(matrices, E, time, rate) for E in basis], axis=1)
    rows = -np.swapaxes(pack(images), 1, 2).reshape(m * size, size)
    columns = np.vstack([np.eye(size), -np.eye(size), rows])
    margin = np.concatenate([np.zeros(2 * size), np.tile(identity, m)])
    offset = np.concatenate([identity, np.zeros(size * (m + 1))])
    x = maximize_margin(np.column_stack([columns, margin]), offset, [n] * (m + 2))
    return None if x is None else np.tensordot(x[:-1], basis, axes=1)
