"""The script that a user would write today: one pair, a floating-point answer, no certificate."""

import cvxpy as cp
import numpy as np


def mode(Bt: float, k: float = 43.0356, Mt: float = 0.01) -> np.ndarray:
    return np.array(
        [
            [0, 1, 0, 0],
            [-1618.80, -56.89, -1, 0],
            [0, 0, -Bt / Mt, k / Mt],
            [1618.80, 28.416, 0, 0],
        ]
    )


Q = cp.Variable((4, 4), symmetric=True)
decrease = [A.T @ Q + Q @ A << -np.eye(4) for A in (mode(2.15), mode(1.04))]
problem = cp.Problem(cp.Minimize(cp.lambda_max(Q)), [Q >> np.eye(4), *decrease])
problem.solve(solver=cp.CLARABEL)
print(problem.status)
