"""How large a signal gets while a stable linear system comes to rest."""

from __future__ import annotations

import numpy as np

from nrs_design.design.transfer import ComplexArray, FloatArray
from nrs_design.models.exponential import expm

# Time constants that a motion is followed for, and samples of each, or of each radian.
_LONG, _FINE = 12.0, 16
_MOST = 20_000


def largest(A: FloatArray, c: FloatArray, x: FloatArray, rates: ComplexArray) -> float:
    """Return the largest ``c exp(A t) x`` over ``t >= 0``.

    Not by python-control, whose grid misses peaks: of 97 % overshoot it finds 96 %. The motion is
    exact, also with repeated poles: a grid resolved for every pole only tells which extremum is the
    highest, and the root of its slope is where that is.
    """
    from scipy.optimize import brentq

    parts = []
    for p in rates[rates.imag >= 0]:
        count = int(min(_LONG * _FINE * (1 + abs(p.imag / p.real)), _MOST))
        t = np.linspace(0, _LONG / -p.real, count)
        parts.append((t, _march(expm(A * t[1]), x, count) @ c))
    times, first = np.unique(np.concatenate([t for t, _ in parts]), return_index=True)
    values = np.concatenate([y for _, y in parts])[first]
    peak = int(values.argmax())

    def slope(t: float) -> float:
        return float(c @ A @ expm(A * t) @ x)

    if 0 < peak < len(times) - 1:
        left, right = times[peak - 1], times[peak + 1]
        if slope(left) > 0 > slope(right):
            # The value is flat there: half the digits of the time give all of its own.
            at = brentq(slope, left, right, rtol=1e-9)
            return max(float(values[peak]), float(c @ expm(A * at) @ x))
    return float(values[peak])


def _march(power: FloatArray, x: FloatArray, count: int) -> FloatArray:
    """Return the states at multiples of a step, doubling their number each time."""
    states = x[None, :]
    while len(states) < count:
        # einsum, because BLAS would start threads for these narrow matrices.
        states = np.concatenate([states, np.einsum("mi,ji->mj", states, power)])
        power = power @ power
    return np.asarray(states[:count], dtype=np.float64)
