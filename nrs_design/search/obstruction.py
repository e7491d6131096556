"""Search for a proof that no common quadratic function exists.

None exists iff there are positive semidefinite ``X_i``, not all zero, with
``sum A_i X_i + X_i A_i' >= 0`` (discrete time: ``sum A_i X_i A_i' - X_i >= 0``).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import NoCommonQuadratic
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.acceptance import Candidate, Candidates
from nrs_design.search.balance import time_unit
from nrs_design.search.family import Family
from nrs_design.search.rates import digits
from nrs_design.search.sdp import SemidefiniteProgram, packed_columns, symmetric_basis, unpack
from nrs_design.search.work import Allowance, Cost

Array = NDArray[np.float64]

FEWEST_BITS = 8
RANK_TOLERANCE = 1e-9


def search_obstruction(family: Family) -> Candidates[NoCommonQuadratic]:
    """Search for a proof that there is no common quadratic function."""
    multipliers = solve_dual(family.matrices, family.system.time, family.allowance)
    if multipliers is None:
        return "the dual has no strict solution"
    for evidence in _roundings(family.system, multipliers, family.exponents):
        yield Candidate(evidence, "no common quadratic function exists")
    return None


def solve_dual(matrices: Array, time: Time, allowance: Allowance | None = None) -> Array | None:
    """Maximize s with ``sum A_i X_i + X_i A_i' >= s I`` over ``X_i >= 0`` of total trace one.

    Returns the X_i, shape (m, n, n), if s > 0; else None. Modes are preferably balanced, and few.
    """
    m, n = matrices.shape[:2]
    own, allowance = n * (n + 1) // 2, allowance or Allowance()
    # Images in full, by their factors and packed, before the program itself is predicted.
    built = Cost(0.0, 8.0 * m * own * (3 * n**2 + 2 * own))
    allowance.require(built, f"a program of {m * own + 1} unknowns")
    basis, zero = symmetric_basis(n), np.zeros((n, n))
    half = np.ldexp(matrices, time_unit(matrices, time))[:, None] @ basis
    images = half + np.swapaxes(half, -1, -2)
    if time is Time.DISCRETE:
        images = half @ np.swapaxes(matrices, -1, -2)[:, None] - basis
    program = SemidefiniteProgram(m * own + 1)
    for k in range(m):
        program.add(zero, [(k * own, np.eye(own))])
    margin = (m * own, packed_columns(-np.eye(n)[None]))
    program.add(zero, [(0, packed_columns(images.reshape(-1, n, n))), margin])
    traces = -np.trace(basis, axis1=1, axis2=2)
    program.add(np.ones((1, 1)), [(0, np.tile(traces, m)[None])])
    found = program.maximize(allowance)
    if found is None or found.x[-1] <= 0:
        return None
    return unpack(found.x[:-1].reshape(m, own), n)


def _roundings(
    system: SwitchedSystem, multipliers: Array, exponents: NDArray[np.int64]
) -> Iterator[NoCommonQuadratic]:
    """Factor ``X_i = L_i L_i'`` and yield rounded factors, in the coordinates of the exact modes.

    The X_i, shape (m, n, n), are in the order of the modes and in coordinates scaled by ``2^d``.
    """
    largest = np.linalg.eigvalsh(multipliers).max()
    if not np.isfinite(largest) or largest <= 0:
        return
    factors = [_factor(X / largest) for X in multipliers]
    shifts = [int(e - exponents.min()) for e in exponents]
    for bits in digits(FEWEST_BITS):
        rounded = []
        for mode, L in zip(system.modes, factors, strict=True):
            integers = tuple(
                tuple(round(float(entry) * 2.0**bits) << shift for entry in row)
                for row, shift in zip(L, shifts, strict=True)
            )
            if any(any(row) for row in integers):
                rounded.append((mode.name, integers))
        if rounded:
            yield NoCommonQuadratic(tuple(rounded))


def _factor(X: Array) -> Array:
    """Return L with ``X = L L'`` up to negligible eigenvalues; at least one column."""
    values, vectors = np.linalg.eigh(X)
    keep = values > min(RANK_TOLERANCE, values.max())
    if not keep.any():
        return np.zeros((len(X), 1))
    return np.asarray(vectors[:, keep] * np.sqrt(values[keep]))
