"""Whether the tare of a force sensor moves, as the air in a record shows."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.statistics import student_quantile, uncertainty

Array = NDArray[np.float64]

_FEWEST = 30
# The air must be spread over this part of the record for a slope to be one of the record.
_SPREAD = 0.3
# Samples of a contact in between.
_BETWEEN = 20
# Drift over the record that matters, as a part of the range of the force.
_MATTERS = 0.005
# Times the half width of the interval of the slope: a drift is not guessed.
_SURE = 2.0


def drifts(time: Array, force: Array, air: NDArray[np.bool_]) -> bool:
    """Tell whether the force in air moves with time.

    Parameters
    ----------
    time, force : ndarray, shape (n,)
        In s and N (N m).
    air : ndarray of bool, shape (n,)
        Which samples are in air.
    """
    if air.sum() < _FEWEST or np.ptp(time[air]) < _SPREAD * np.ptp(time):
        return False
    # Within one stretch, a tissue that is soft at first would pass for a drift.
    rows = np.flatnonzero(air)
    if np.diff(rows).max() < _BETWEEN:
        return False
    X = np.column_stack([np.ones(int(air.sum())), time[air] - time[air].mean()])
    found = np.linalg.lstsq(X, force[air], rcond=None)[0]
    known = uncertainty(X, force[air] - X @ found)
    error = math.sqrt(float(known.covariance[1, 1]))
    sure = abs(found[1]) > _SURE * student_quantile(known.degrees) * error
    matters = abs(found[1]) * np.ptp(time) > _MATTERS * np.ptp(force)
    return bool(sure and matters)
