"""Search for a function that shows that contact settles under a constant force (untrusted).

Margin form: maximize t subject to ``0 <= Q <= I``, a bounded slope, and every condition of
`nrs_design.proof.evidence.constant_force` with at least t to spare. All of them are of one order.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.evidence import ConstantForce
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import NO_MARGIN, OUT_OF_RANGE, Candidate, Candidates
from nrs_design.search.family import Family
from nrs_design.search.interior_point import Cones, maximize_last, step_cost
from nrs_design.search.lmi import FEWEST_STEPS, START_FLOOR, time_unit
from nrs_design.search.motions import Motions, numerators, separating_coordinates
from nrs_design.search.rounding import digits, unscale
from nrs_design.search.sdp import pack, symmetric_basis
from nrs_design.work import Allowance, Cost

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
    allowance, (m, n) = allowance or Allowance(), A.shape[:2]
    basis = symmetric_basis(n)
    moving, crossing = A.copy(), np.zeros_like(A)
    moving[:, -1] = 0.0
    crossing[:, -1] = A[:, -1]
    moves = np.concatenate([A, moving])
    half = basis[:, None] @ moves
    # Decreases in contact and free, then Q, I - Q and the slope within its bounds.
    images, counted = np.zeros((len(basis) + 2, 2 * m + 3, n, n)), 2 * m
    images[: len(basis), :counted] = -(half + np.swapaxes(half, -1, -2))
    images[: len(basis), counted], images[: len(basis), counted + 1] = basis, -basis
    images[-2, m:counted] = -(crossing + np.swapaxes(crossing, -1, -2))
    images[-2, counted + 2, 0, 0], images[-2, counted + 2, 1, 1] = 1.0, -1.0
    images[-1, :counted] = -np.eye(n)
    constant = np.zeros(images.shape[1:])
    constant[counted + 1 :] = np.eye(n)
    constant[-1, 0, 0], constant[-1, 1, 1] = 0.0, LARGEST_SLOPE
    step = step_cost(len(images), len(constant), n)
    described = f"a program of {len(images)} unknowns and {len(constant)} blocks"
    allowance.require(Cost(FEWEST_STEPS * step.work, step.memory), described)
    cones = Cones(constant, images)
    start = np.concatenate([pack(np.eye(n) / 2), [1.0, 0.0]])
    here = cones.at(start)[:counted]
    start[-1] = np.linalg.eigvalsh(here).min() - max(0.1 * np.abs(here).max(), START_FLOOR)
    y = maximize_last(cones, start, lambda: allowance.goes_on(step.work), SMALLEST_MARGIN)
    if not y[-1] > 0:
        return None
    return np.asarray(np.tensordot(y[: len(basis)], basis, axes=1)), float(y[-2])
