"""What a coarse sensor of position does to a fit."""

from __future__ import annotations

import numpy as np

from nrs_design.identification.numeric import Array, Flags, usual_step

# Changes of a rounded signal are multiples of the rounding step: largest relative deviation from a
# multiple, and least fraction of multiples.
_WHOLE = 0.06
_LEAST_SHARE = 0.9
# Size of a small change in steps, and least share of small changes.
_SMALL = 10.5
_SHARE = 0.1
# Changes that stand out between two equal ones: least number, and least share of all changes.
_FEWEST_BLIPS, _BLIPS = 2, 0.05
# Number of candidate steps: both the sensor and the digits of the file round a reading.
_CANDIDATES = 50


def resolution(readings: Array) -> float:
    """Return the step to which readings are rounded, 0 if no step shows.

    Where a motion is even, rounding lets single changes stand out between two equal ones (0, 0, q,
    0, 0 or 3q, 3q, 4q, 3q): by a step. A clean ramp has no such changes, whatever its own change
    from sample to sample is. Of the steps that stand out, the largest is taken of which all other
    small changes are multiples.
    """
    changes = np.diff(readings)
    sizes = np.abs(changes)
    exact = max(
        1e-9 * float(sizes.max(initial=0.0)),
        4 * np.finfo(float).eps * float(np.abs(readings).max(initial=0.0)),
    )
    sizes = sizes[sizes > exact]
    before, center, after = changes[:-2], changes[1:-1], changes[2:]
    blips = np.abs(center - before)[np.abs(after - before) <= exact]
    blips = np.sort(blips[blips > exact])
    found = 0.0
    for step in np.unique(blips[:: -(-len(blips) // _CANDIDATES) or 1]).tolist():
        enough = int(np.sum(_are_whole(blips, step)))
        if enough < max(_FEWEST_BLIPS, _BLIPS * len(sizes)):
            continue
        small = sizes[sizes < _SMALL * step]
        if len(small) < _SHARE * len(sizes):
            continue
        if float(np.mean(_are_whole(small, step))) > _LEAST_SHARE:
            found = step
    return found


def _are_whole(sizes: Array, step: float) -> Flags:
    """Tell which sizes are positive multiples of a step."""
    ratios = sizes / step
    whole = np.round(ratios)
    return np.asarray((whole > 0) & (np.abs(ratios - whole) < _WHOLE * whole))


def rounding_of_velocity(time: Array, readings: Array) -> float:
    """Return the part of a velocity's power that rounding of the position accounts for.

    A rounding error has the variance ``q^2/12``, a difference over two steps twice that.
    """
    noise = resolution(readings) ** 2 / 6 / (2 * usual_step(time)) ** 2
    return noise / float(np.mean(np.gradient(readings, time) ** 2))


def rounding_scatter(readings: Array, sensitivities: Array, slope: float) -> Array:
    """Return the covariance of ``J'e``, shape (p, p), when e is the error that rounding causes.

    As long as the reading does not change, neither does its error: every stretch of equal
    readings has one error with the variance ``q^2/12``, whatever the number of its samples. The
    slope is output over position.
    """
    starts = np.concatenate([[0], np.flatnonzero(np.diff(readings)) + 1])
    sums = np.add.reduceat(sensitivities, starts, axis=0)
    scatter: Array = (sums.T @ sums) * (slope * resolution(readings)) ** 2 / 12
    return scatter


def noise_variance(x: Array) -> float:
    """Return the variance of white noise on a smooth signal, and of its rounding."""
    rough = np.diff(x, 3)
    # The binomial coefficients 1, 3, 3, 1 have squares that add up to 20.
    return float(rough @ rough) / len(rough) / 20 + resolution(x) ** 2 / 12
