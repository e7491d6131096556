"""Semidefinite programs for Clarabel: packing of symmetric matrices and one solve (untrusted).

By hand, as CVXPY takes longer to be loaded and to bring such a program into this form than Clarabel
takes to solve it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from nrs_design.search.interior_point import ConeGroup
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]

# Work per program, per cone and per entry of the constraints. Work in each step of the solver: per
# step, per entry of the blocks of cones, and per multiplication of the factorization.
PER_PROGRAM = 1e-3
PER_CONE = 5e-5
PER_ENTRY = 5e-8
PER_STEP = 1e-5
PER_BLOCK_ENTRY = 7.5e-8
PER_PRODUCT = 3e-11
# Predicted number of steps of the solver, and largest number.
STEPS = 15
MOST_STEPS = 200
# Bytes for each entry of the dense constraints (with copies), and for each entry of the factors.
BYTES_PER_ENTRY = 24
BYTES_PER_FACTOR_ENTRY = 20


def symmetric_basis(n: int) -> Array:
    """Return the orthonormal basis of symmetric n x n matrices, in the solver's order."""
    return unpack(np.eye(n * (n + 1) // 2), n)


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
    """Predict what a program takes, perhaps before it is built.

    `shared` unknowns remain coupled when each cone's own have been eliminated; a cone is its order,
    and how many unknowns it depends on.
    """
    rows, entries, products, factor = 0.0, 0.0, shared**3 / 3, shared**2 / 2
    count = 0
    for order, unknown_count in cones:
        size = order * (order + 1) / 2
        count += 1
        rows += size
        entries += size**2
        products += size**3 / 3 + size * unknown_count * (size + unknown_count)
        factor += size * (size / 2 + unknown_count)
    memory = BYTES_PER_ENTRY * rows * variables + BYTES_PER_FACTOR_ENTRY * factor
    step = PER_STEP + PER_BLOCK_ENTRY * entries + PER_PRODUCT * products
    built = PER_PROGRAM + PER_CONE * count + PER_ENTRY * rows * variables
    return Cost(built + STEPS * step, memory, step)


@dataclass(frozen=True, slots=True)
class Maximum:
    """What the solver returned, whatever its status."""

    x: Array  # Shape (N,). The unknowns.
    duals: list[Array]  # Change of the margin for a unit of each block


@dataclass(frozen=True, slots=True)
class Block:
    """What must be positive semidefinite, packed."""

    order: int
    constant: Array  # Shape (s,)
    unknowns: NDArray[np.int64]  # Indices of the unknowns in the block, shape (k,)
    images: Array  # Shape (s, k)


class SemidefiniteProgram:
    """Make the last unknown as large as all blocks stay positive semidefinite with.

    A block is ``C + sum of x_k F_k`` over the few unknowns that it depends on.
    """

    def __init__(self, unknowns: int) -> None:
        self.unknowns = unknowns
        self._blocks = list[Block]()

    def add(self, constant: Array, images: Sequence[tuple[int, Array]]) -> None:
        """Add a block: a constant, and packed forms with the index of the first unknown."""
        places = [range(first, first + image.shape[1]) for first, image in images]
        # NumPy's own union loads what takes longer than a common quadratic function.
        unknowns = np.array(sorted({k for place in places for k in place}))
        offset = pack(constant)
        whole = np.zeros((len(offset), len(unknowns)))
        for place, (_, image) in zip(places, images, strict=True):
            whole[:, np.searchsorted(unknowns, place)] += image
        is_used = whole.any(axis=0)
        self._blocks.append(Block(len(constant), offset, unknowns[is_used], whole[:, is_used]))

    def cost(self) -> Cost:
        """Predict what a solution takes: unknowns of one block alone are eliminated with it."""
        unknowns = np.concatenate([block.unknowns for block in self._blocks])
        is_shared = np.bincount(unknowns, minlength=self.unknowns) > 1
        cones = ((block.order, len(block.unknowns)) for block in self._blocks)
        return program_cost(self.unknowns, int(is_shared.sum()), cones)

    @cached_property
    def groups(self) -> list[ConeGroup]:
        """Blocks of one size in which the same unknowns enter are a group."""
        alike: dict[object, list[Block]] = {}
        for block in self._blocks:
            alike.setdefault((block.order, block.unknowns.tobytes()), []).append(block)
        return [
            ConeGroup(
                blocks[0].unknowns,
                unpack(np.array([block.constant for block in blocks]), blocks[0].order),
                unpack(np.array([block.images.T for block in blocks]), blocks[0].order),
            )
            for blocks in alike.values()
        ]

    def maximize(self, allowance: Allowance) -> Maximum | None:
        """Return the solution with any status; None if an entry is not finite.

        The steps that it made are charged.
        """
        import clarabel
        from scipy.sparse import csc_matrix

        cost, count, blocks = self.cost(), self.unknowns, self._blocks
        allowance.take(cost, f"a program of {count} unknowns and {len(blocks)} blocks")
        affordable_steps = allowance.left / cost.per_step
        first = np.cumsum([0, *(len(block.constant) for block in blocks)])
        entries = list[tuple[Array, NDArray[np.int64], NDArray[np.int64]]]()
        for start, block in zip(first, blocks, strict=False):
            row, column = np.nonzero(block.images)
            entries.append((-block.images[row, column], start + row, block.unknowns[column]))
        values, rows, columns = (np.concatenate(part) for part in zip(*entries, strict=True))
        matrix = csc_matrix((values, (rows, columns)), (int(first[-1]), count))
        objective, quadratic = np.zeros(count), csc_matrix((count, count))
        objective[-1] = -1.0
        cones = [clarabel.PSDTriangleConeT(block.order) for block in blocks]
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
        settings.max_iter = STEPS + int(min(affordable_steps, MOST_STEPS - STEPS))
        settings.time_limit = allowance.fuse.left
        problem = quadratic, objective, matrix, np.concatenate([b.constant for b in blocks]), cones
        solution = clarabel.DefaultSolver(*problem, settings).solve()
        if solution.status == clarabel.SolverStatus.NumericalError and solution.iterations < 2:
            # The solver fails at once on a few scaled programs, and solves them without scaling.
            settings.equilibrate_enable = False
            solution = clarabel.DefaultSolver(*problem, settings).solve()
        allowance.charge((solution.iterations - STEPS) * cost.per_step)
        x, z = (np.asarray(part, dtype=float) for part in (solution.x, solution.z))
        if x.shape != (count,) or not (np.isfinite(x).all() and np.isfinite(z).all()):
            return None
        duals = zip(np.split(z, first[1:-1]), blocks, strict=True)
        return Maximum(x, [unpack(part, block.order) for part, block in duals])


def packed_columns(forms: Array) -> Array:
    """Return forms, shape (N, s, s), as columns of a block."""
    return pack(forms).T


def packed_congruence(L: Array, R: Array) -> Array:
    """Return the packed upper half of ``L Q R'`` for each packed entry of Q."""
    a, b = triangle(len(L))
    i, j = triangle(L.shape[1])
    products = L[a][:, i] * R[b][:, j] + L[a][:, j] * R[b][:, i]
    scales = np.where(a == b, 1.0, np.sqrt(2.0))[:, None] * np.where(i == j, 0.5, np.sqrt(0.5))
    return np.asarray(scales * products)
