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
from nrs_design.search.sdp import solve_blocks, symmetric_basis
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
    pairs, rate = np.ldexp(pairs, unit), float(np.ldexp(rate, unit))
    basis, zero = symmetric_basis(n), np.zeros((n, n))
    size = len(basis)

    def block(low: Array | None, high: Array | None, margin: float = 1.0) -> Array:
        images = np.zeros((2 * size + 1, n, n))
        for part, columns in ((low, slice(size)), (high, slice(size, 2 * size))):
            if part is not None:
                images[columns] = part
        images[-1] = -margin * np.eye(n)
        return images

    blocks = [(np.eye(n), block(-basis, None, 0.0)), (np.eye(n), block(None, -basis, 0.0))]
    wanted = [block(basis, None), block(None, basis)]
    for A, B in pairs:
        at_low, at_high = (decreases(M, basis, Time.CONTINUOUS, rate) for M in (A, B))
        wanted += [block(at_low, None), block(None, at_high), block(at_high, at_low)]
    x = solve_blocks([*blocks, *((zero, images) for images in wanted)], allowance)
    if x is None or x[-1] <= 0:
        return None
    return np.asarray(np.tensordot(x[:-1].reshape(2, size), basis, axes=1))
