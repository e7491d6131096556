"""First-order difference equations with varying factors, without a loop."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def run_first_order(factors: Array, inputs: Array) -> Array:
    """Run ``y[i + 1] = factors[i] y[i] + inputs[i]`` from zero.

    Parameters
    ----------
    factors, inputs : ndarray, shape (n,)
        Solved as a bidiagonal system, which takes as long as a filter with a constant factor.

    Returns
    -------
    ndarray, shape (n + 1,)
        Beginning with y[0] = 0.
    """
    from scipy.linalg.lapack import dtbtrs

    banded = np.ones((2, len(inputs)), order="F")
    banded[1, :-1] = -factors[1:]
    solution, _ = dtbtrs(banded, inputs[:, None], uplo="L")
    return np.concatenate([[0.0], solution[:, 0]])
