"""Search for a quadratic function that is affine in one constant parameter."""

from __future__ import annotations

from functools import partial

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import ParameterQuadratic
from nrs_design.proof.mode import Time
from nrs_design.search.candidates import NO_MARGIN, Candidate, Candidates
from nrs_design.search.decay import fastest_first
from nrs_design.search.family import Family
from nrs_design.search.lmi import decreases, time_unit
from nrs_design.search.rounding import digits, unscale
from nrs_design.search.sdp import (
    begin,
    maximize_margin,
    pack,
    program_cost,
    symmetric_basis,
)
from nrs_design.work import Allowance

Array = NDArray[np.float64]

NEAREST = 0.999
FEWEST_BITS = 6


def search_parameter_quadratic(family: Family) -> Candidates[ParameterQuadratic]:
    """Search for the function with the largest rate."""
    system, allowance = family.system, family.allowance
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    ends = [(index[low], index[high]) for low, high in system.switching.fixed_ends]
    solve = partial(_solve, family.matrices[np.array(ends)])
    if solve(0.0, allowance) is None:
        return NO_MARGIN
    for functions, claim in fastest_first(
        solve, family.limit, system.time, allowance, nearest=NEAREST
    ):
        unit = int(np.frexp(np.abs(functions).max())[1])
        for bits in digits(FEWEST_BITS):
            (first, denominator_log2), (last, _) = (
                unscale(np.ldexp(Q, -unit), family.exponents, bits) for Q in functions
            )
            yield Candidate(ParameterQuadratic(first, last, denominator_log2, claim))
    return None


def _solve(pairs: Array, rate: float, allowance: Allowance) -> Array | None:
    """Maximize the margin of all conditions; return both ends of Q, shape (2, n, n)."""
    n, unit = pairs.shape[-1], time_unit(pairs, Time.CONTINUOUS)
    unknowns, blocks = n * (n + 1) + 1, 4 + 3 * len(pairs)
    cost = program_cost(unknowns, unknowns, [(n, unknowns)] * blocks)
    begun = begin(allowance, cost, f"a program of {unknowns} unknowns and {blocks} blocks")
    pairs, rate = np.ldexp(pairs, unit), float(np.ldexp(rate, unit))
    basis, identity = symmetric_basis(n), pack(np.eye(n))
    size = len(basis)
    rows, constants = [], []

    def add_cone(low: Array | None, high: Array | None, margin: float, constant: float) -> None:
        block = np.zeros((size, 2 * size + 1))
        for images, columns in ((low, slice(0, size)), (high, slice(size, 2 * size))):
            if images is not None:
                block[:, columns] = -pack(images).T
        block[:, -1] = margin * identity
        rows.append(block)
        constants.append(constant * identity)

    add_cone(-basis, None, 0.0, 1.0)
    add_cone(None, -basis, 0.0, 1.0)
    add_cone(basis, None, 1.0, 0.0)
    add_cone(None, basis, 1.0, 0.0)
    for A, B in pairs:
        at_low, at_high = (decreases(M, basis, Time.CONTINUOUS, rate) for M in (A, B))
        add_cone(at_low, None, 1.0, 0.0)
        add_cone(None, at_high, 1.0, 0.0)
        add_cone(at_high, at_low, 1.0, 0.0)
    sizes = [n] * len(rows)
    x = maximize_margin(np.vstack(rows), np.concatenate(constants), sizes, begun)
    if x is None or x[-1] <= 0:
        return None
    return np.tensordot(x[:-1].reshape(2, size), basis, axes=1)
