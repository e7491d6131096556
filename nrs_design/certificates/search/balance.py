"""Exact diagonal scaling by powers of two, common to a family of matrices (untrusted search)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.switched.system import Time

SWEEPS = 64


def balance(matrices: NDArray[np.float64]) -> NDArray[np.int64]:
    """Choose exponents d so that ``2^-d A 2^d`` has rows and columns of like size.

    Osborne's iteration on the sum of the absolute values of all matrices, rounded to powers of
    two so that scaling loses nothing. A zero row or column keeps its scale.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        The family.

    Returns
    -------
    ndarray of int, shape (n,)
        Exponents.
    """
    total = np.abs(matrices).sum(axis=0)
    np.fill_diagonal(total, 0.0)
    exponents = np.zeros(len(total), dtype=np.int64)
    for _ in range(SWEEPS):
        before = exponents.copy()
        for i in range(len(total)):
            row, column = total[i].sum(), total[:, i].sum()
            if 0 < row < np.inf and 0 < column < np.inf:
                step = int(np.rint(0.5 * (np.log2(row) - np.log2(column))))
                exponents[i] += step
                total[i] = np.ldexp(total[i], -step)
                total[:, i] = np.ldexp(total[:, i], step)
        if np.array_equal(before, exponents):
            break
    return exponents


def scale(matrices: NDArray[np.float64], exponents: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return ``2^-d A 2^d`` for every matrix; exact but for under- and overflow."""
    scaled: NDArray[np.float64] = np.ldexp(matrices, exponents[None, :] - exponents[:, None])
    return scaled


def mean_norm_coordinates(matrices: NDArray[np.float64], time: Time) -> NDArray[np.float64]:
    """Return T such that in coordinates ``x = T z`` the mean of the modes' own norms is round.

    Each stable mode has the norm ``x' P x`` of its Lyapunov equation, scaled to trace one.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        Stable modes.
    time : Time
        Continuous or discrete.
    """
    n, identity = matrices.shape[1], np.eye(matrices.shape[1])
    mean = np.zeros((n, n))
    for A in matrices:
        if time is Time.CONTINUOUS:
            operator = np.kron(A.T, identity) + np.kron(identity, A.T)
        else:
            operator = np.kron(A.T, A.T) - np.eye(n * n)
        P = np.linalg.solve(operator, -identity.ravel()).reshape(n, n)
        mean += (P + P.T) / np.trace(P)
    return np.asarray(np.linalg.inv(np.linalg.cholesky(mean)).T)
