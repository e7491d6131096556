"""Search for a quadratic function that is affine in one constant parameter."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.certificates.evidence import ParameterQuadratic
from nrs_design.certificates.search.allowance import Allowance
from nrs_design.certificates.search.decay import bisect_position
from nrs_design.certificates.search.lmi import decreases, time_unit
from nrs_design.certificates.search.rounding import round_rate, unscale
from nrs_design.certificates.search.sdp import (
    maximize_margin,
    pack,
    program_cost,
    symmetric_basis,
)
from nrs_design.switched.system import SwitchedSystem, Time

Array = NDArray[np.float64]

BITS = (6, 8, 10, 14, 20, 28, 40, 50)
BACK_OFFS = (0.999, 0.99, 0.9, 0.5, 0.1, 1e-3)


def find_parameter_quadratic(
    system: SwitchedSystem,
    matrices: Array,
    exponents: NDArray[np.int64],
    limit: float,
    allowance: Allowance | None = None,
) -> ParameterQuadratic | None:
    """Search for the function with the largest rate, round it, and check.

    Parameters
    ----------
    system : SwitchedSystem
        Exact modes, continuous time, with `fixed_ends`.
    matrices : ndarray, shape (m, n, n)
        The modes in coordinates scaled by ``2^d``.
    exponents : ndarray of int, shape (n,)
        The d.
    limit : float
        Rate of the slowest mode, in 1/s.
    allowance : Allowance, optional
        Time and memory; unlimited by default.

    Raises
    ------
    NotAffordableError
        If time or memory do not suffice for a first function.
    """
    allowance = allowance or Allowance()
    index = {mode.name: k for k, mode in enumerate(system.modes)}
    ends = [(index[low], index[high]) for low, high in system.switching.fixed_ends]
    pairs = matrices[np.array(ends)]
    if _solve(pairs, 0.0, allowance) is None:
        return None
    half = allowance.part(0.5)
    best = bisect_position(lambda s: _solve(pairs, s * limit, half) is not None)
    for back_off in BACK_OFFS:
        rate = best * back_off * limit
        functions = _solve(pairs, rate, allowance)
        if functions is None or rate <= 0:
            continue
        claimed = round_rate(rate, Time.CONTINUOUS)
        unit = int(np.frexp(np.abs(functions).max())[1])
        for bits in BITS:
            (first, denominator_log2), (last, _) = (
                unscale(np.ldexp(Q, -unit), exponents, bits) for Q in functions
            )
            evidence = ParameterQuadratic(first, last, denominator_log2, claimed)
            if evidence.find_fault(system) is None:
                return evidence
    return None


def _solve(pairs: Array, rate: float, allowance: Allowance) -> Array | None:
    """Maximize the margin of all conditions; return both ends of Q, shape (2, n, n)."""
    n, unit = pairs.shape[-1], time_unit(pairs, Time.CONTINUOUS)
    unknowns, blocks = n * (n + 1) + 1, 4 + 3 * len(pairs)
    cost = program_cost(unknowns, unknowns, [(n, unknowns)] * blocks)
    allowance.take(cost, f"a program of {unknowns} unknowns and {blocks} blocks")
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
    x = maximize_margin(
        np.vstack(rows), np.concatenate(constants), sizes, time_limit=allowance.left
    )
    if x is None or x[-1] <= 0:
        return None
    return np.tensordot(x[:-1].reshape(2, size), basis, axes=1)
