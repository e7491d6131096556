"""What a coarse sensor of position does to a fit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Small changes of a rounded signal are whole numbers of its step: so near, and so many of them.
_WHOLE = 0.06
_MOST = 0.9
# What is small, in steps; and how many of the changes must be.
_SMALL = 10.5
_SHARE = 0.1
# A probe rests where a reading stays so many times longer than usual.
_REST = 3.0


def resolution(readings: Array) -> float:
    """Return the step to which readings are rounded, 0 if no step shows.

    The smallest change that occurs is the step, if the other small changes are multiples of it.
    """
    changes = np.abs(np.diff(readings))
    changes = changes[changes > 1e-9 * changes.max(initial=0.0)]
    if not len(changes):
        return 0.0
    ratios = changes / changes.min()
    small = ratios[ratios < _SMALL]
    if len(small) < _SHARE * len(ratios):
        return 0.0
    whole = np.abs(small - np.round(small)) < _WHOLE * np.round(small)
    return float(changes.min()) if np.mean(whole) > _MOST else 0.0


def rounding_of_velocity(time: Array, readings: Array) -> float:
    """Return the part of a velocity's power that rounding of the position accounts for.

    A rounding error has the variance ``q^2/12``, a difference over two steps twice that.
    """
    noise = resolution(readings) ** 2 / 6 / (2 * float(np.median(np.diff(time)))) ** 2
    return noise / float(np.mean(np.gradient(readings, time) ** 2))


def rounding_scatter(
    readings: Array, sensitivities: Array, slope: float, *, returns: bool = False
) -> Array:
    """Return the covariance of ``J'e`` when e is the error that rounding causes.

    As long as the reading does not change, neither does its error: every stretch of equal
    readings has one error with the variance ``q^2/12``, whatever the number of its samples.

    Parameters
    ----------
    readings : ndarray, shape (n,)
        Rounded position.
    sensitivities : ndarray, shape (n, p)
        J, derivatives of the output by the logarithms of the parameters.
    slope : float
        Output over position: a stiffness, or 1 where the position is the output.
    returns : bool
        Whether a probe that comes back to a reading comes back to the same error, as it does at its
        rest: what hangs on the place of the rest is not told better by more of them.

    Returns
    -------
    ndarray, shape (p, p)
        In squared units of the output.
    """
    starts = np.concatenate([[0], np.flatnonzero(np.diff(readings)) + 1])
    sums = np.add.reduceat(sensitivities, starts, axis=0)
    if returns:
        lengths = np.diff([*starts, len(readings)])
        rests = lengths > _REST * np.median(lengths)
        _, same = np.unique(readings[starts[rests]], return_inverse=True)
        together = np.zeros((same.max(initial=-1) + 1, sensitivities.shape[1]))
        np.add.at(together, same, sums[rests])
        sums = np.concatenate([sums[~rests], together])
    scatter: Array = (sums.T @ sums) * (slope * resolution(readings)) ** 2 / 12
    return scatter
