"""Semidefinite programs for Clarabel: packing of symmetric matrices and one solve (untrusted)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def symmetric_basis(n: int) -> Array:
    """Return the orthonormal basis of symmetric n x n matrices, in the solver's order."""
    i, j = triangle(n)
    basis = np.zeros((len(i), n, n))
    weight = np.where(i == j, 1.0, np.sqrt(0.5))
    basis[np.arange(len(i)), i, j] = weight
    basis[np.arange(len(i)), j, i] = weight
    return basis


def pack(matrices: Array) -> Array:
    """Return the coordinates of symmetric matrices, shape (..., n, n) to (..., n(n+1)/2)."""
    i, j = triangle(matrices.shape[-1])
    return np.asarray(matrices[..., i, j] * np.where(i == j, 1.0, np.sqrt(2.0)), dtype=float)


def unpack(coordinates: Array, n: int) -> Array:
    """Return symmetric matrices from their coordinates; the inverse of `pack`."""
    i, j = triangle(n)
    matrices = np.zeros((*coordinates.shape[:-1], n, n))
    scaled = coordinates / np.where(i == j, 1.0, np.sqrt(2.0))
    matrices[..., i, j] = scaled
    matrices[..., j, i] = scaled
    return matrices


def triangle(n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the row and column indices of the upper triangle, column by column."""
    column, row = np.tril_indices(n)
    return row, column


def maximize_margin(
    rows: Array, offset: Array, sizes: Sequence[int], equalities: int = 0
) -> Array | None:
    """Maximize the last variable subject to ``offset - rows x`` in a product of cones.

    Parameters
    ----------
    rows : ndarray, shape (M, N)
        The first `equalities` rows are equations, the others packed positive semidefinite cones.
    offset : ndarray, shape (M,)
        Right-hand side.
    sizes : sequence of int
        Order of each cone.
    equalities : int
        Number of equations.

    Returns
    -------
    ndarray, shape (N,), or None
        What the solver returned, whatever its status; None if that is not finite.
    """
    import clarabel
    from scipy import sparse

    variables = rows.shape[1]
    objective = np.zeros(variables)
    objective[-1] = -1.0
    cones: list[Any] = [clarabel.ZeroConeT(equalities)] if equalities else []
    cones += [clarabel.PSDTriangleConeT(n) for n in sizes]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    solution: Any = clarabel.DefaultSolver(
        sparse.csc_matrix((variables, variables)),
        objective,
        sparse.csc_matrix(rows),
        offset,
        cones,
        settings,
    ).solve()
    x = np.asarray(solution.x, dtype=float)
    return x if x.shape == (variables,) and np.isfinite(x).all() else None
