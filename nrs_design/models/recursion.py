"""First-order difference equations with varying factors, without a loop."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", np.float64, np.complex128)


def run_first_order(factors: NDArray[Scalar], inputs: NDArray[Scalar]) -> NDArray[Scalar]:
    """Run ``y[i + 1] = factors[i] y[i] + inputs[i]`` from y[0] = 0, real or complex; n + 1 values.

    Solved as a bidiagonal system, which takes as long as a filter with a constant factor.
    """
    from scipy.linalg.lapack import dtbtrs, ztbtrs

    banded = np.ones((2, len(inputs)), dtype=factors.dtype, order="F")
    banded[1, :-1] = -factors[1:]
    solve = ztbtrs if np.iscomplexobj(inputs) else dtbtrs
    solution, _ = solve(banded, inputs[:, None], uplo="L")
    return np.concatenate([np.zeros(1, solution.dtype), solution[:, 0]])
