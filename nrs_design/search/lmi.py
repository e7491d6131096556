"""Search for a common quadratic Lyapunov function by semidefinite programming (untrusted).

Margin form: maximize t subject to ``Q > 0`` of a fixed trace and a decrease of at least t in every
mode.
Only the modes that the last solution violates enter the solver. A solver's status is never
evidence: whatever it returns goes through the exact check.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.search.cones import ConeKind, FormsCones, FormTerm, transposed
from nrs_design.search.interior_point import FormsPoint, maximize
from nrs_design.work import Allowance, Cost

Matrices = NDArray[np.float64]

FIRST_MODES = 8
# In continuous time, the unit of time is chosen so that the largest entry is just below 2^3.
ENTRY_LOG2 = 3
# A smaller margin counts as zero, relative to Q, for the modes that the solver knew.
MARGIN_FLOOR = 1e-10
# The method of our own is not begun if fewer steps than these fit.
FEWEST_STEPS = 4


def decreases(matrices: Matrices, Q: Matrices, time: Time, rate: float) -> Matrices:
    """Return, for every mode, the matrix that must be positive definite; shape (m, n, n).

    The rate is alpha in 1/s, or rho per step; a stack of Q must broadcast with the modes.
    """
    if time is Time.CONTINUOUS:
        half = Q @ matrices
        return -(half + np.swapaxes(half, -1, -2)) - 2 * rate * Q
    return rate**2 * Q - np.swapaxes(matrices, -1, -2) @ Q @ matrices


def margins(matrices: Matrices, Q: Matrices, time: Time, rate: float) -> Matrices:
    """Return the smallest eigenvalue of every mode's decrease; shape (m,)."""
    return np.asarray(np.linalg.eigvalsh(decreases(matrices, Q, time, rate))[:, 0], dtype=float)


def find_common_quadratic(
    matrices: Matrices,
    time: Time,
    rate: float,
    allowance: Allowance | None = None,
) -> Matrices | None:
    """Look for Q with ``A'Q + QA + 2 rate Q < 0`` (or ``A'QA < rate^2 Q``) for all modes.

    Modes are preferably balanced. Returns a solution with positive margins in floating point, or
    None; a `NotAffordableError` if work or memory do not suffice, and nothing was found.
    """
    allowance = allowance or Allowance()
    unit = time_unit(matrices, time)
    matrices, rate = np.ldexp(matrices, unit), float(np.ldexp(rate, unit))
    m, n = matrices.shape[:2]
    active = sorted({k * (m - 1) // (FIRST_MODES - 1) for k in range(FIRST_MODES)})
    start: Matrices = np.eye(n)
    while True:
        Q = solve_by_interior_point(matrices[active], time, rate, start, allowance)
        if not np.isfinite(decreases(matrices, Q, time, rate)).all():
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
) -> Matrices:
    """Improve on Q in the margin form for the given modes, with the method of our own."""
    (m, n), whole, back = matrices.shape[:2], np.eye(matrices.shape[1])[None], transposed(matrices)
    if time is Time.CONTINUOUS:
        slow = -back - rate * whole
        terms = FormTerm(0, whole, slow), FormTerm(0, slow, whole)
    else:
        terms = FormTerm(0, rate**2 * whole, whole), FormTerm(0, -back, back)
    cones = FormsCones([n], 0, [ConeKind(terms, (), True, m, n)])
    step = cones.cost()
    what = f"a program of {n * (n + 1) // 2} unknowns and {m + 1} blocks"
    allowance.require(Cost(FEWEST_STEPS * step.work, step.memory), what)
    start = FormsPoint([Q], np.zeros(0), 0.0)
    return maximize(cones, start, lambda: allowance.goes_on(step.work)).forms[0]
