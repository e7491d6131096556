"""Types of arrays, and small steps that several fits share."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Rows = NDArray[np.int64]

TINY = float(np.finfo(float).tiny)
# A column below this has faded to denormal numbers, whose digits say nothing.
_FADED = 1e-300
# Largest number of evaluations in a search.
_STEPS = 100
# Relative change of the squared errors, and change of the scaled parameters.
_CONVERGED, _SETTLED = 1e-12, 1e-9


def usual_step(time: Array) -> float:
    """Return the usual time between samples."""
    return float(np.median(np.diff(time)))


def column_sizes(X: Array) -> Array:
    """Return the norm of each column, never 0."""
    return np.asarray(np.maximum(np.linalg.norm(X, axis=0), _FADED))


def reject(basis: Array, values: Array) -> Array:
    """Return the rejection of values from orthonormal columns."""
    return np.asarray(values - basis @ (basis.T @ values), float)


def smoothed(values: Array, count: int) -> Array:
    """Return the moving average over `count` values; the end values continue outside."""
    padded = np.pad(values, (count // 2, count - 1 - count // 2), mode="edge")
    return np.convolve(padded, np.full(count, 1 / count), "valid")


def bic(errors: Array, count: int, floor: float = TINY) -> float:
    """Return the Bayesian information criterion of a fit, up to a constant of its data.

    A power of the errors below the least one is rounding, and no better.
    """
    n = len(errors)
    power = max(float(errors @ errors), floor)
    return n * float(np.log(power / n)) + count * float(np.log(n))


def parted(changes: Flags) -> list[tuple[int, int]]:
    """Return first row and end of the stretches that changes between neighbours part."""
    return list(pairwise([0, *(np.flatnonzero(changes) + 1).tolist(), len(changes) + 1]))


def runs(flags: Flags) -> list[tuple[int, int]]:
    """Return first row and end of every stretch of true flags."""
    edges = np.flatnonzero(np.diff(flags, prepend=False, append=False)).tolist()
    return list(zip(edges[::2], edges[1::2], strict=True))


Errors = Callable[[Array], Array]  # From parameters (p,) to measured less fitted output (n,)


def search(
    errors: Errors,
    sensitivities: Errors,
    start: Array,
    scale: Array | float = 1.0,
    bounds: tuple[Array | float, Array | float] = (-np.inf, np.inf),
    converged: float = _CONVERGED,
) -> tuple[Array, bool]:
    """Return the parameters, and whether the search has settled.

    Sensitivities are of the fitted output, shape (n, p). A first step is of the size of the scale.
    """
    from scipy.optimize import least_squares

    size = float(np.linalg.norm(errors(start))) or 1.0
    low, high = ((np.asarray(end) - start) / scale for end in bounds)

    def missed(z: Array) -> Array:
        return errors(start + scale * z) / size

    def slopes(z: Array) -> Array:
        return -sensitivities(start + scale * z) * scale / size

    found = least_squares(
        missed,
        np.zeros(len(start)),
        jac=slopes,
        bounds=(low, high),
        ftol=converged,
        xtol=_SETTLED,
        gtol=None,
        max_nfev=_STEPS,
    )
    return start + scale * np.asarray(found.x, float), bool(found.success)
