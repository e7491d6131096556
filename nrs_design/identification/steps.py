"""Steps of a search by Gauss and Newton."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def limited_step(step: Array, limit: Array) -> Array:
    """Shorten a step as a whole until no part of it is beyond its limit.

    It keeps its direction, along which errors fall: parts that are cut one by one would leave a
    narrow valley.

    Parameters
    ----------
    step, limit : ndarray, shape (p,)
        In the units of the parameters; limits are positive.
    """
    return step / max(1.0, float(np.max(np.abs(step) / limit)))
