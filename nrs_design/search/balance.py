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
# Larger Lyapunov equations are solved by Schur decompositions, not as one linear system, for which
# SciPy need not be loaded.
DENSE_ORDER = 10


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


def mean_norm_coordinates(matrices: NDArray[np.float64], time: Time) -> NDArray[np.float64]:
    """Return T such that in coordinates ``x = T z`` the mean of the modes' own norms is round.

    Each mode is stable, and has the norm ``x' P x`` of its Lyapunov equation, scaled to trace one.
    """
    return round_coordinates(mean_norm(matrices, time))


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
    """Return the sum of the matrices of the modes' own norms, each of trace two."""
    P = own_norms(matrices, time)
    return np.asarray((2 * P / np.trace(P, axis1=1, axis2=2)[:, None, None]).sum(axis=0))


def own_norms(matrices: NDArray[np.float64], time: Time) -> NDArray[np.float64]:
    """Solve ``A'P + PA = -I``, in discrete time ``A'PA - P = -I``; shape (m, n, n)."""
    m, n = matrices.shape[:2]
    identity, back = np.eye(n), np.swapaxes(matrices, 1, 2)
    if n > DENSE_ORDER:
        from scipy.linalg import solve_continuous_lyapunov, solve_discrete_lyapunov

        if time is Time.CONTINUOUS:
            P = np.array([solve_continuous_lyapunov(A, -identity) for A in back])
        else:
            P = np.array([solve_discrete_lyapunov(A, identity, "bilinear") for A in back])
    else:
        sides = (back, back) if time is Time.DISCRETE else (back, identity)
        whole = np.einsum("...ik,...jl->...ijkl", *sides)
        whole = np.broadcast_to(whole, (m, n, n, n, n))
        if time is Time.CONTINUOUS:
            whole = whole + whole.transpose(0, 2, 1, 4, 3)
        operator = whole.reshape(m, n * n, n * n) - (time is Time.DISCRETE) * np.eye(n * n)
        P = np.linalg.solve(operator, np.full((m, n * n, 1), -identity.reshape(-1, 1)))
        P = P.reshape(m, n, n)
    return np.asarray((P + np.swapaxes(P, 1, 2)) / 2)
