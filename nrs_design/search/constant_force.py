"""Search for a function that shows that contact settles under a constant force (untrusted).

Margin form: maximize t subject to ``0 <= Q <= I``, a bounded slope, and every condition of
`nrs_design.proof.evidence.constant_force` with at least t to spare.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import ConstantForce
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.search.lmi import time_unit
from nrs_design.search.motions import Motions, numerators, separating_coordinates
from nrs_design.search.rounding import digits, unscale
from nrs_design.search.sdp import solve_blocks, symmetric_basis
from nrs_design.work import Allowance

Array = NDArray[np.float64]

# The slope lies between 0 and this, in coordinates where all numbers are of like size.
LARGEST_SLOPE = 64.0
# Rounding takes about as much as a smaller margin gives.
SMALLEST_MARGIN = 1e-10


def search_constant_force(
    system: SwitchedSystem, allowance: Allowance
) -> Candidates[ConstantForce]:
    """Yield functions, with ever more digits.

    Parameters
    ----------
    system : SwitchedSystem
        In continuous time, with contact that can be lost.
    allowance : Allowance
        Work and memory.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    family = Family.of(system)
    motions = Motions.of(family)
    T = separating_coordinates(motions)
    A = motions.transformed(T).contact
    if not (np.isfinite(T).all() and np.isfinite(A).all()):
        return OUT_OF_RANGE
    found = find_constant_force(np.ldexp(A, time_unit(A, motions.time)), allowance)
    if found is None:
        return NO_MARGIN
    inverse = np.linalg.inv(T)
    Q = inverse.T @ found[0] @ inverse
    exponent = int(np.frexp(np.abs(Q).max())[1])
    # The slope times the square of the deflection is a part of V.
    slope = np.ldexp(found[1] / T[-1, -1] ** 2, -exponent - 2 * int(family.exponents[-1]))
    for bits in digits():
        rows, log2 = unscale(np.ldexp(Q, -exponent), family.exponents, bits)
        (rounded,) = numerators(np.array([slope]), log2)
        yield Candidate(ConstantForce(rows, max(log2, 0), rounded))
    return None


def find_constant_force(A: Array, allowance: Allowance | None = None) -> tuple[Array, float] | None:
    """Return Q and the slope of a function with positive margins in floating point, or None.

    Parameters
    ----------
    A : ndarray, shape (m, n, n)
        Modes in contact, of like norms and of rates about one.
    allowance : Allowance, optional
        Work and memory; unlimited by default.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    n, basis = A.shape[-1], symmetric_basis(A.shape[-1])
    unknowns, one = len(basis) + 2, np.ones((1, 1))
    number, crossing = np.zeros((unknowns, 1, 1)), np.zeros_like(A)
    number[-2] = 1.0
    crossing[:, -1] = A[:, -1]
    bounded = np.zeros((unknowns, n, n))
    bounded[:-2] = basis
    blocks = [(0 * one, number), (LARGEST_SLOPE * one, -number)]
    blocks += [(np.zeros((n, n)), bounded), (np.eye(n), -bounded)]
    for moves, slope in [(A, 0 * A), (A - crossing, crossing)]:
        for M, C in zip(moves, slope, strict=True):
            half = basis @ M
            images = np.concatenate([half, C[None], np.eye(n)[None] / 2])
            blocks.append((np.zeros((n, n)), -(images + np.swapaxes(images, -1, -2))))
    x = solve_blocks(blocks, allowance or Allowance())
    if x is None or x[-1] <= SMALLEST_MARGIN:
        return None
    return np.asarray(np.tensordot(x[:-2], basis, axes=1)), float(x[-2])
