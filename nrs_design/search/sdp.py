"""Semidefinite programs for Clarabel: packing of symmetric matrices and one solve (untrusted).

By hand, as CVXPY takes longer to be loaded and to bring such a program into this form than Clarabel
takes to solve it; off the hot path, `nrs_design.search.raw` leaves that to CVXPY.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from math import inf
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.allowance import Allowance, Cost

Array = NDArray[np.float64]

# Seconds per multiplication in the factorizations of a whole solution, and per program.
PER_PRODUCT = 5e-9
PER_PROGRAM = 2e-3
# Bytes for each entry of the dense constraints (with the copies), and of the factors.
PER_ENTRY = 24
PER_FACTOR_ENTRY = 20


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
    return np.asarray(matrices[..., i, j] * _weights(matrices.shape[-1]), dtype=float)


def unpack(coordinates: Array, n: int) -> Array:
    """Return symmetric matrices from their coordinates; the inverse of `pack`."""
    i, j = triangle(n)
    matrices = np.zeros((*coordinates.shape[:-1], n, n))
    scaled = coordinates / _weights(n)
    matrices[..., i, j] = scaled
    matrices[..., j, i] = scaled
    return matrices


@cache
def triangle(n: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return the row and column indices of the upper triangle, column by column.

    Kept, and not to be written to: to find them takes longer than to use them.
    """
    column, row = np.tril_indices(n)
    for indices in (row, column):
        indices.setflags(write=False)
    return row, column


@cache
def _weights(n: int) -> Array:
    """Return the factors that make coordinates of `triangle` orthonormal."""
    i, j = triangle(n)
    factors = np.where(i == j, 1.0, np.sqrt(2.0))
    factors.setflags(write=False)
    return factors


def program_cost(variables: int, shared: int, cones: Iterable[tuple[int, int]]) -> Cost:
    """Predict what `maximize_margin` takes, before its constraints are built.

    Parameters
    ----------
    variables : int
        Number of unknowns.
    shared : int
        How many of them remain coupled when each cone's own have been eliminated.
    cones : iterable of (int, int)
        Order of each cone, and how many unknowns it depends on.
    """
    rows, products, factor = 0.0, shared**3 / 3, shared**2 / 2
    for order, touched in cones:
        size = order * (order + 1) / 2
        rows += size
        products += size**3 / 3 + size * touched * (size + touched)
        factor += size * (size / 2 + touched)
    memory = PER_ENTRY * rows * variables + PER_FACTOR_ENTRY * factor
    return Cost(PER_PROGRAM + PER_PRODUCT * products, memory)


def solve_blocks(blocks: Sequence[tuple[Array, Array]], allowance: Allowance) -> Array | None:
    """Make the last unknown as large as all blocks stay positive semidefinite with.

    Parameters
    ----------
    blocks : sequence of (ndarray, ndarray), shapes (m, m) and (N, m, m)
        A constant, and what every unknown adds to it.
    allowance : Allowance
        Time and memory.

    Returns
    -------
    ndarray, shape (N,), or None
        As `maximize_margin` returns it.
    """
    unknowns = len(blocks[0][1])
    cost = program_cost(unknowns, unknowns, [(len(constant), unknowns) for constant, _ in blocks])
    allowance.take(cost, f"a program of {unknowns} unknowns and {len(blocks)} blocks")
    return maximize_margin(
        np.concatenate([-pack(images).T for _, images in blocks]),
        np.concatenate([pack(constant) for constant, _ in blocks]),
        [len(constant) for constant, _ in blocks],
        time_limit=allowance.left,
    )


def maximize_margin(
    rows: Array,
    offset: Array,
    sizes: Sequence[int],
    equalities: int = 0,
    time_limit: float = inf,
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
    time_limit : float
        The solver ends after so many seconds, with what it has.

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
    settings.time_limit = time_limit
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
