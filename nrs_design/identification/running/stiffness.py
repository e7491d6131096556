"""Slope of force over deflection in windows of a log, each with an interval for its noise."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from nrs_design.identification.datasets.checks import gaps_in
from nrs_design.identification.numeric import Array, Rows, beyond, parted
from nrs_design.identification.rounding import resolution
from nrs_design.identification.statistics import joint_level, student_quantile

FEWEST_ROWS = 20
# For how many times its estimate the noise of the deflection is taken.
_NOISIER = 2.0


@dataclass(frozen=True, slots=True)
class Window:
    """Slope of force over deflection in one window."""

    # first, last: first row, and the row after the last one.
    first: int
    last: int
    value: float  # Least squares, in force over deflection
    # low, high: how far noise may have moved it, at 95 % for all windows together; infinite where
    # nothing moves. The slope is the stiffness only if that does not change within the window.
    low: float
    high: float


def cut_windows(time: Array, states: Rows, length: float) -> Iterator[tuple[int, int]]:
    """Yield first row and end of windows, of a length in s, that span neither a gap nor a change.

    What stays the same in a window is the state of its rows: the mode, and whether a torque acts.
    """
    for begin, end in parted(gaps_in(time) | (np.diff(states) != 0)):
        count = max(round(float(time[end - 1] - time[begin]) / length), 1)
        cuts = np.linspace(begin, end, count + 1).astype(int).tolist()
        for first, last in itertools.pairwise(cuts):
            if last - first >= FEWEST_ROWS:
                yield first, last


def stiffness_of(
    time: Array, deflection: Array, force: Array, spans: list[tuple[int, int]]
) -> list[Window]:
    """Estimate ``F = c + k x + b x'`` in every window.

    The lower end is that of the regression of force on deflection, which noise of the deflection
    draws towards zero. The upper end is the smaller of two: that of the reverse regression, which
    noise of the force draws away (Frisch 1934); and the lower one without the part of the
    deflection that may be noise. Correlation of the errors widens both.
    """
    confidence = joint_level(max(len(spans), 1))
    # Backward: a later angle has been moved by the force that is regressed.
    change = np.diff(deflection) / np.diff(time)
    velocity = np.concatenate([change[:1], change])
    return [
        _window((first, last), deflection, velocity, force, confidence) for first, last in spans
    ]


def _window(
    span: tuple[int, int], deflection: Array, velocity: Array, force: Array, confidence: float
) -> Window:
    first, last = span
    x, v, f = (column[first:last] for column in (deflection, velocity, force))
    others = np.column_stack([np.ones_like(x), v / max(float(np.abs(v).max()), 1e-300)])
    basis, _ = np.linalg.qr(others)
    x, y = beyond(basis, x), beyond(basis, f)
    power, cross = float(x @ x), float(x @ y)
    if power <= 1e-20 or cross == 0.0:
        return Window(first, last, 0.0, -math.inf, math.inf)
    k = cross / power
    quantile = student_quantile(len(x) - 3, confidence)
    half = quantile * _error(x, y)
    # One over the stiffness, in the reverse regression.
    yielding = abs(cross) / float(y @ y) - quantile * _error(y, x)
    reverse = 1 / yielding if yielding > 0 else math.inf
    # The part of the power of the deflection that is no noise.
    real = 1 - _NOISIER * noise_variance(deflection[first:last]) * len(x) / power
    drawn = (abs(k) + half) / real if real > 0 else math.inf
    low = abs(k) - half
    if low < 0:
        low = low / real if real > 0 else -math.inf
    high = min(reverse, drawn)
    return Window(first, last, k, *((low, high) if k > 0 else (-high, -low)))


def noise_variance(x: Array) -> float:
    """Return the variance of white noise on a smooth signal, and of its rounding."""
    rough = np.diff(x, 3)
    # The binomial coefficients 1, 3, 3, 1 have squares that add up to 20.
    return float(rough @ rough) / len(rough) / 20 + resolution(x) ** 2 / 12


def _error(x: Array, y: Array) -> float:
    """Return the standard error of the slope of y over x, whose errors may be correlated."""
    power = float(x @ x)
    rest = y - float(x @ y) / power * x
    size = float(rest @ rest)
    alike = float(rest[1:] @ rest[:-1]) / max(size, 1e-300)
    inflation = (1 + max(alike, 0.0)) / max(1 - alike, 1e-3)
    return math.sqrt(size / (len(x) - 3) / power * inflation)
