"""The exponential of small matrices of floats; SciPy has it too, but takes 0.3 s to load."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.enclosure import precision


def expm(A: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``exp(A)``, by flint."""
    from flint import arb_mat

    with precision():
        E = arb_mat(A.tolist()).exp()
    return np.array([float(ball.mid()) for ball in E.entries()]).reshape(A.shape)
