"""Exact diagonal scaling by powers of two, common to a family of matrices (untrusted search)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

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
