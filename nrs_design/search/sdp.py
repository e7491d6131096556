"""Semidefinite programs for Clarabel: packing of symmetric matrices and one solve (untrusted).

By hand, as CVXPY takes longer to be loaded and to bring such a program into this form than Clarabel
takes to solve it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.work import Allowance, Cost

Array = NDArray[np.float64]

# Work per program, per cone of it and per entry of its constraints; and in each step of the solver,
# per entry of the blocks that cones add to its equations, and per multiplication in their
# factorization.
PER_PROGRAM = 1e-3
PER_CONE = 5e-5
PER_ENTRY = 5e-8
PER_STEP = 1e-5
PER_BLOCK_ENTRY = 7.5e-8
PER_PRODUCT = 3e-11
# A prediction counts so many steps; the solver makes fewer or more, and ever at most the last.
STEPS = 15
MOST_STEPS = 200
# Bytes for each entry of the dense constraints (with the copies), and of the factors.
BYTES_PER_ENTRY = 24
BYTES_PER_FACTOR_ENTRY = 20


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

    `shared` unknowns remain coupled when each cone's own have been eliminated; a cone is its order,
    and how many unknowns it depends on.
    """
    rows, entries, products, factor = 0.0, 0.0, shared**3 / 3, shared**2 / 2
    count = 0
    for order, touched in cones:
        size = order * (order + 1) / 2
        count += 1
        rows += size
        entries += size**2
        products += size**3 / 3 + size * touched * (size + touched)
        factor += size * (size / 2 + touched)
    memory = BYTES_PER_ENTRY * rows * variables + BYTES_PER_FACTOR_ENTRY * factor
    step = PER_STEP + PER_BLOCK_ENTRY * entries + PER_PRODUCT * products
    built = PER_PROGRAM + PER_CONE * count + PER_ENTRY * rows * variables
    return Cost(built + STEPS * step, memory, step)


@dataclass(frozen=True, slots=True)
class Sparse:
    """A matrix by columns, as Clarabel reads it; to load SciPy for it takes longer than a solve."""

    data: Array
    indices: NDArray[np.int32]  # Rows of the entries, in order in each column
    indptr: NDArray[np.int32]  # Where columns begin
    shape: tuple[int, int]
    has_canonical_format: bool = True

    @property
    def nnz(self) -> int:
        """Number of entries."""
        return len(self.data)

    @classmethod
    def of(
        cls, values: Array, rows: NDArray[Any], columns: NDArray[Any], shape: tuple[int, int]
    ) -> Sparse:
        """Put entries in order; what is given twice counts as their sum."""
        places, entry = np.unique(columns * shape[0] + rows, return_inverse=True)
        data: Array = np.bincount(entry, values, len(places)).astype(float)
        ends = np.searchsorted(places, np.arange(shape[1] + 1) * shape[0])
        return cls(data, (places % shape[0]).astype(np.int32), ends.astype(np.int32), shape)


@dataclass(frozen=True, slots=True)
class Maximum:
    """What the solver returned, whatever its status."""

    x: Array  # Shape (N,). The unknowns.
    z: Array  # Shape (M,). The dual variables of the rows.


@dataclass(frozen=True, slots=True)
class Begun:
    """A program whose predicted work has been charged, and that a solver is to solve."""

    allowance: Allowance  # What may still be done
    per_step: float  # Work of each step of the solver

    @property
    def most_steps(self) -> int:
        """How many steps the solver may make: then it ends with what it has."""
        more = self.allowance.left / self.per_step if self.per_step else MOST_STEPS
        return STEPS + int(min(more, MOST_STEPS - STEPS))

    def end(self, steps: int) -> None:
        """Charge the steps that were made instead of those that were predicted."""
        self.allowance.charge((steps - STEPS) * self.per_step)


def begin(allowance: Allowance, cost: Cost, what: str) -> Begun:
    """Charge the work that a program is predicted to take, if it fits."""
    allowance.take(cost, what)
    return Begun(allowance, cost.per_step)


class Blocks:
    """Matrices that must stay positive semidefinite, of which each depends on few unknowns."""

    def __init__(self) -> None:
        self._sizes, self._offsets, self._count = list[int](), list[Array](), 0
        self._entries: list[tuple[Array, NDArray[np.int64], NDArray[np.int64]]] = []

    def add(self, constant: Array | float, images: Mapping[int, Array]) -> None:
        """Add a constant, and what some unknowns add to it, by their numbers."""
        packed = -pack(np.array([*images.values()]))
        image, row = np.nonzero(packed)
        unknowns = np.array([*images])[image]
        self._entries.append((packed[image, row], self._count + row, unknowns))
        size = next(iter(images.values())).shape[0]
        self._offsets.append(pack(np.broadcast_to(constant, (size, size))))
        self._sizes.append(size)
        self._count += packed.shape[1]

    def maximize(self, unknowns: int, begun: Begun) -> Maximum | None:
        """Maximize the last unknown, as `maximize_margin` does."""
        values, rows, columns = (np.concatenate(part) for part in zip(*self._entries, strict=True))
        matrix = Sparse.of(values, rows, columns, (self._count, unknowns))
        return maximize_margin(matrix, np.concatenate(self._offsets), self._sizes, begun)


def solve_blocks(blocks: Sequence[tuple[Array, Array]], allowance: Allowance) -> Array | None:
    """Make the last unknown as large as all blocks stay positive semidefinite with.

    A block is a constant (m, m), and what every unknown adds to it (N, m, m). Returns the unknowns.
    """
    unknowns = len(blocks[0][1])
    cost = program_cost(unknowns, unknowns, [(len(constant), unknowns) for constant, _ in blocks])
    begun = begin(allowance, cost, f"a program of {unknowns} unknowns and {len(blocks)} blocks")
    program = Blocks()
    for constant, images in blocks:
        program.add(constant, dict(enumerate(images)))
    found = program.maximize(unknowns, begun)
    return None if found is None else found.x


def maximize_margin(
    rows: Sparse, offset: Array, sizes: Sequence[int], begun: Begun
) -> Maximum | None:
    """Maximize the last variable subject to ``offset - rows x`` in a product of cones.

    The cones are packed positive semidefinite matrices of these sizes. Returns what the solver
    returned, whatever its status; None if that is not finite.
    """
    import clarabel

    variables = rows.shape[1]
    objective = np.zeros(variables)
    objective[-1] = -1.0
    cones = [clarabel.PSDTriangleConeT(n) for n in sizes]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    settings.max_iter = begun.most_steps
    settings.time_limit = begun.allowance.fuse.left
    none = np.zeros(0)
    quadratic = Sparse.of(none, none, none, (variables, variables))

    def solve() -> Any:
        return clarabel.DefaultSolver(quadratic, objective, rows, offset, cones, settings).solve()

    solution = solve()
    if solution.status == clarabel.SolverStatus.NumericalError and solution.iterations < 2:
        # It fails at once on a few programs that it has scaled, and solves them unscaled.
        settings.equilibrate_enable = False
        solution = solve()
    begun.end(solution.iterations)
    x, z = (np.asarray(part, dtype=float) for part in (solution.x, solution.z))
    found = x.shape == (variables,) and np.isfinite(x).all() and np.isfinite(z).all()
    return Maximum(x, z) if found else None
