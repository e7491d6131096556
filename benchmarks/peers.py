"""What a user would do without this package. None of it proves anything."""

from __future__ import annotations

import multiprocessing
import warnings
from dataclasses import dataclass

import cvxpy as cp
import numpy as np
from numpy.typing import NDArray

Matrices = NDArray[np.float64]
FIRST_MODES = 8


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


def solve_lazily(matrices: Matrices) -> Solution:
    """Solve for few modes and add the most violated ones until none is."""
    active = list(range(min(FIRST_MODES, len(matrices))))
    while True:
        solution = solve_all_at_once(matrices[active])
        half = solution.Q @ matrices
        worst = np.linalg.eigvalsh(half + half.transpose(0, 2, 1))[:, -1]
        violated = [i for i in np.argsort(-worst) if worst[i] >= 0 and i not in active]
        if not violated:
            return solution
        active += violated[: len(active)]


def gradient_ends_within(matrices: Matrices, seconds: float) -> bool:
    """Tell whether the iteration of Liberzon and Tempo finds a function in that time."""
    context = multiprocessing.get_context("fork")
    process = context.Process(target=_iterate, args=(matrices,))
    process.start()
    process.join(seconds)
    ended = not process.is_alive()
    if not ended:
        process.terminate()
        process.join()
    return ended


def _iterate(matrices: Matrices) -> None:
    from nrs_design.proof.mode import Time
    from nrs_design.search.gradient import iterate_gradient
    from nrs_design.search.gradient_settings import Gradient

    iterate_gradient(matrices, Time.CONTINUOUS, Gradient(radius=1e-2, max_updates=10**9))
