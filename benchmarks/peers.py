"""What a user would do without this package. None of it proves anything."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

Matrices = NDArray[np.float64]


@dataclass(frozen=True)
class Solution:
    """What the solver says: its status, the margin t and the matrix Q, shape (n, n)."""

    status: str
    t: float
    Q: Matrices


def solve_all_at_once(matrices: Matrices) -> Solution:
    """Maximize t with ``0 <= Q <= I`` and ``A'Q + QA <= -t I`` for all modes in one problem."""
    n = matrices.shape[1]
    Q, t = cp.Variable((n, n), symmetric=True), cp.Variable()
    decrease = [A.T @ Q + Q @ A << -t * np.eye(n) for A in matrices]
    problem = cp.Problem(cp.Maximize(t), [Q >> 0, Q << np.eye(n), *decrease])
    with warnings.catch_warnings():
        # "May be inaccurate" is in the status, too.
        warnings.simplefilter("ignore", UserWarning)
        problem.solve(solver=cp.CLARABEL)
    return Solution(str(problem.status), float(problem.value), np.asarray(Q.value))
