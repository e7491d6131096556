"""Exact diagonal scaling by powers of two, common to a family of matrices (untrusted search).

By hand, as every proof passes here: to load SciPy's `matrix_balance` takes longer than the proof.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time

SWEEPS = 64
# In continuous time, the unit of time is chosen so that the largest entry is just below 2^3.
ENTRY_LOG2 = 3
# Lyapunov equations: largest residual power, most doublings, and bound of a diverging power.
NOTHING_LEFT, DOUBLINGS, LARGEST_POWER = 1e-10, 60, 1e50


def balance(matrices: NDArray[np.float64]) -> NDArray[np.int64]:
    """Choose exponents d so that ``2^-d A 2^d`` has rows and columns of like size.

    Osborne's iteration on the sum of the absolute values of all matrices, rounded to powers of
    two so that scaling loses nothing. A zero row or column keeps its scale.
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


def scale_states(
    matrices: NDArray[np.float64], exponents: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return ``2^-d A 2^d`` for every matrix; exact but for under- and overflow."""
    scaled: NDArray[np.float64] = np.ldexp(matrices, exponents[None, :] - exponents[:, None])
    return scaled


def time_unit(matrices: NDArray[np.float64], time: Time) -> int:
    """Choose the unit of time, two to this power, by the largest entry."""
    if time is Time.DISCRETE:
        return 0
    return ENTRY_LOG2 - int(np.frexp(np.abs(matrices).max())[1])


def round_coordinates(P: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return an upper triangular T such that ``x' P x`` is ``|z|^2`` for ``x = T z``."""
    return np.asarray(np.linalg.inv(np.linalg.cholesky(P)).T)


def separating(P: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return coordinates in which a form is nearly round, and which leave the last state alone."""
    T = np.zeros_like(P)
    T[:-1, :-1] = round_coordinates(P[:-1, :-1])
    T[-1, -1] = 1 / np.sqrt(P[-1, -1])
    return T


def mean_norm(matrices: NDArray[np.float64], time: Time) -> NDArray[np.float64]:
    """Return the sum of the matrices of the modes' own norms ``x' P x``, each of trace two."""
    P = own_norms(matrices, time)
    return np.asarray((2 * P / np.trace(P, axis1=1, axis2=2)[:, None, None]).sum(axis=0))


def own_norms(matrices: NDArray[np.float64], time: Time) -> NDArray[np.float64]:
    """Solve ``A'P + PA = -I``, in discrete time ``A'PA - P = -I``, of stable modes (m, n, n).

    P is the sum of ``M'^k W M^k``, of which each round takes twice as many; in continuous time, M
    and W are those of Cayley. A LinAlgError if a mode is not stable.
    """
    M, W = matrices, np.broadcast_to(np.eye(matrices.shape[-1]), matrices.shape)
    if time is Time.CONTINUOUS:
        size = np.sqrt((matrices**2).mean(axis=(1, 2)) * matrices.shape[-1])[:, None, None]
        inverse = np.linalg.inv(size * W - matrices)
        M, W = inverse @ (size * W + matrices), 2 * size * (np.swapaxes(inverse, 1, 2) @ inverse)
    for _ in range(DOUBLINGS):
        W = W + np.swapaxes(M, 1, 2) @ W @ M
        M = M @ M
        if (left := np.abs(M).max()) < NOTHING_LEFT:
            return np.asarray((W + np.swapaxes(W, 1, 2)) / 2)
        if not left < LARGEST_POWER:
            break
    raise np.linalg.LinAlgError("a mode that is not stable has no norm")
