"""Search for a common quadratic Lyapunov function by semidefinite programming (untrusted).

Margin form: maximize t subject to ``0 <= Q <= I`` and a decrease of at least t in every mode.
Only the modes that the last solution violates enter the solver. A solver's status is never
evidence: whatever it returns goes through the exact check.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.search.interior_point import Cones, maximize_last, step_cost
from nrs_design.search.sdp import (
    begin,
    maximize_margin,
    pack,
    program_cost,
    symmetric_basis,
)
from nrs_design.work import Allowance, Cost

Matrices = NDArray[np.float64]
Solve = Callable[[Matrices, Time, float, Matrices, Allowance], Matrices | None]

FIRST_MODES = 8
# In continuous time, the unit of time is chosen so that the largest entry is just below 2^3.
ENTRY_LOG2 = 3
# A smaller margin counts as zero, relative to Q, for the modes that the solver knew.
MARGIN_FLOOR = 1e-10
# The start lies below the margin of its Q by at least this.
START_FLOOR = 1e-3
# The method of our own is not begun if fewer steps than these fit.
FEWEST_STEPS = 4


def decreases(matrices: Matrices, Q: Matrices, time: Time, rate: float) -> Matrices:
    """Return, for every mode, the matrix that must be positive definite; shape (m, n, n).

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        The modes.
    Q : ndarray, shape (n, n)
        Of the quadratic function; a stack of them must broadcast with the modes.
    time : Time
        Which inequality.
    rate : float
        The alpha in 1/s, or rho per step.
    """
    if time is Time.CONTINUOUS:
        half = Q @ matrices
        return -(half + np.swapaxes(half, -1, -2)) - 2 * rate * Q
    return rate**2 * Q - np.swapaxes(matrices, -1, -2) @ Q @ matrices


def margins(matrices: Matrices, Q: Matrices, time: Time, rate: float) -> Matrices:
    """Return the smallest eigenvalue of every mode's decrease; shape (m,).

    Parameters
    ----------
    matrices, Q, time, rate
        As for `decreases`.
    """
    return np.asarray(np.linalg.eigvalsh(decreases(matrices, Q, time, rate))[:, 0], dtype=float)


def find_common_quadratic(
    matrices: Matrices,
    time: Time,
    rate: float,
    solve: Solve | None = None,
    allowance: Allowance | None = None,
) -> Matrices | None:
    """Look for Q with ``A'Q + QA + 2 rate Q < 0`` (or ``A'QA < rate^2 Q``) for all modes.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        Modes, preferably balanced.
    time : Time
        Continuous or discrete.
    rate : float
        Decay rate in 1/s, or contraction per step.
    solve : callable, optional
        Solves the margin form for some of the modes, beginning at a Q between 0 and I; a method
        of our own by default.
    allowance : Allowance, optional
        Work and memory; unlimited by default.

    Returns
    -------
    ndarray, shape (n, n), or None
        A solution with positive margins in floating point, or None.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice, and nothing was found.
    """
    solve, allowance = solve or solve_by_interior_point, allowance or Allowance()
    unit = time_unit(matrices, time)
    matrices, rate = np.ldexp(matrices, unit), float(np.ldexp(rate, unit))
    m, n = matrices.shape[:2]
    active = sorted({k * (m - 1) // (FIRST_MODES - 1) for k in range(FIRST_MODES)})
    start: Matrices = np.eye(n) / 2
    while True:
        Q = solve(matrices[active], time, rate, start, allowance)
        if Q is None or not np.isfinite(decreases(matrices, Q, time, rate)).all():
            return None
        margin = margins(matrices, Q, time, rate)
        if margin.min() > 0:
            return Q
        allowance.check()
        if margin[active].min() <= MARGIN_FLOOR * np.abs(Q).max():
            return None
        violated = [k for k in np.argsort(margin) if margin[k] <= 0 and k not in active]
        active, start = sorted([*active, *violated[: len(active)]]), Q


def time_unit(matrices: Matrices, time: Time) -> int:
    """Choose the unit of time, two to this power, by the largest entry; Q does not depend on it."""
    if time is Time.DISCRETE:
        return 0
    return ENTRY_LOG2 - int(np.frexp(np.abs(matrices).max())[1])


def solve_by_interior_point(
    matrices: Matrices, time: Time, rate: float, Q: Matrices, allowance: Allowance
) -> Matrices | None:
    """Improve on Q in the margin form for the given modes, with the method of our own.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        The modes that count.
    time : Time
        Which inequality.
    rate : float
        The alpha in 1/s, or rho per step.
    Q : ndarray, shape (n, n)
        Where to begin.
    allowance : Allowance
        Work and memory that are left.
    """
    m, n = matrices.shape[:2]
    step = step_cost(n * (n + 1) // 2 + 1, m + 2, n)
    allowance.require(Cost(FEWEST_STEPS * step.work, step.memory), _described(m, n))
    basis, identity = symmetric_basis(n), np.eye(n)
    constant, images = np.zeros((m + 2, n, n)), np.zeros((len(basis) + 1, m + 2, n, n))
    constant[1] = identity
    images[:-1, 0], images[:-1, 1] = basis, -basis
    images[:-1, 2:] = decreases(matrices, basis[:, None], time, rate)
    images[-1, 2:] = -identity
    here = decreases(matrices, Q, time, rate)
    below = np.linalg.eigvalsh(here).min() - max(0.1 * np.abs(here).max(), START_FLOOR)
    start = np.append(pack(Q), below)
    y = maximize_last(Cones(constant, images), start, lambda: allowance.goes_on(step.work))
    return np.asarray(np.tensordot(y[:-1], basis, axes=1))


def solve_by_clarabel(
    matrices: Matrices, time: Time, rate: float, Q: Matrices, allowance: Allowance
) -> Matrices | None:
    """Solve the margin form for the given modes; None if the result is not finite.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        The modes that count.
    time : Time
        Which inequality.
    rate : float
        The alpha in 1/s, or rho per step.
    Q : ndarray, shape (n, n)
        A place to begin, which this solver does not need.
    allowance : Allowance
        Work and memory that are left.
    """
    m, n = matrices.shape[:2]
    unknowns = n * (n + 1) // 2 + 1
    cost = program_cost(unknowns, unknowns, [(n, unknowns)] * (m + 2))
    begun = begin(allowance, cost, _described(m, n))
    basis, identity = symmetric_basis(n), pack(np.eye(n))
    size = len(basis)
    images = decreases(matrices, basis[:, None], time, rate)
    rows = -np.moveaxis(pack(images), 0, 2).reshape(m * size, size)
    columns = np.vstack([np.eye(size), -np.eye(size), rows])
    margin = np.concatenate([np.zeros(2 * size), np.tile(identity, m)])
    offset = np.concatenate([identity, np.zeros(size * (m + 1))])
    rows = np.column_stack([columns, margin])
    x = maximize_margin(rows, offset, [n] * (m + 2), begun)
    return None if x is None else np.tensordot(x[:-1], basis, axes=1)


def _described(modes: int, order: int) -> str:
    return f"a program of {order * (order + 1) // 2} unknowns and {modes + 2} blocks"
