"""A common quadratic function by CVXPY: the condition as textbooks write it (untrusted).

For conditions off the hot path: to load CVXPY takes longer than most proofs.
"""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.search.lmi import find_common_quadratic
from nrs_design.search.sdp import Begun, begin, program_cost
from nrs_design.work import Allowance, Cost

Matrices = NDArray[np.float64]

# Work to load the library, and to bring one program into the form of the solver.
LOADING = 2.0
PER_PROGRAM = 0.05


def find_raw_quadratic(
    matrices: Matrices, time: Time, rate: float, allowance: Allowance
) -> Matrices | None:
    """Look for Q with ``A'Q + QA + 2 rate Q < 0`` (or ``A'QA < rate^2 Q``) for all modes.

    Parameters
    ----------
    matrices : ndarray, shape (m, n, n)
        Modes, in the coordinates of the spec.
    time : Time
        Continuous or discrete.
    rate : float
        Decay rate in 1/s, or contraction per step.
    allowance : Allowance
        Work and memory.

    Returns
    -------
    ndarray, shape (n, n), or None
        A candidate with positive margins in floating point, or None.

    Raises
    ------
    NotAffordableError
        If work or memory do not suffice.
    """
    allowance.take(Cost(LOADING), "loading CVXPY")
    return find_common_quadratic(matrices, time, rate, _solve, allowance)


def _solve(
    matrices: Matrices, time: Time, rate: float, start: Matrices, allowance: Allowance
) -> Matrices | None:
    """Maximize t subject to ``0 <= Q <= I`` and a decrease of at least t in every mode."""
    # CVXPY refuses a program with coefficients beyond floating point; none exceeds these.
    if not np.isfinite(np.square(2 * matrices)).all():
        return None
    import cvxpy as cp

    m, n = matrices.shape[:2]
    unknowns = n * (n + 1) // 2 + 1
    cost = program_cost(unknowns, unknowns, [(n, unknowns)] * (m + 2))
    cost = replace(cost, work=PER_PROGRAM + cost.work)
    begun = begin(allowance, cost, f"a program of {unknowns - 1} unknowns and {m + 2} blocks")
    Q, t, identity = cp.Variable((n, n), symmetric=True), cp.Variable(), np.eye(n)
    conditions = [Q >> 0, Q << identity]
    for A in matrices:
        if time is Time.CONTINUOUS:
            change = A.T @ Q + Q @ A + 2 * rate * Q
        else:
            change = A.T @ Q @ A - rate**2 * Q
        conditions.append(change + t * identity << 0)
    problem: Any = cp.Problem(cp.Maximize(t), conditions)
    try:
        # That a solution may be inaccurate is no news: no solver is trusted.
        with warnings.catch_warnings(action="ignore"):
            solve_by_cvxpy(problem, begun)
    except cp.SolverError:
        return None
    found = Q.value
    return found if found is not None and np.isfinite(found).all() else None


def solve_by_cvxpy(problem: Any, begun: Begun) -> None:
    """Solve a program of CVXPY by Clarabel, within the steps that it may make.

    Raises
    ------
    cvxpy.SolverError
        If the solver fails.
    """
    import cvxpy as cp

    problem.solve(
        solver=cp.CLARABEL,
        max_threads=1,
        max_iter=begun.most_steps,
        time_limit=begun.seconds,
    )
    begun.end(problem.solver_stats.num_iters)
