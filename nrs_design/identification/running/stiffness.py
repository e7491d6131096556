"""Stiffness in windows of a log, each with an interval that holds whatever is noisy."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.statistics import CONFIDENCE, student_quantile

Array = NDArray[np.float64]

FEWEST_ROWS = 20
# A gap of more than so many usual steps ends a window.
_GAP = 3.0


@dataclass(frozen=True, slots=True)
class Window:
    """Stiffness in one window.

    Parameters
    ----------
    first, last : int
        First row, and the row after the last one.
    value : float
        Least squares, in force over deflection.
    low, high : float
        The interval, at 95 % for all windows together; infinite where nothing moves.
    """

    first: int
    last: int
    value: float
    low: float
    high: float


def cut_windows(
    time: Array, modes: NDArray[np.int64] | None, length: float
) -> Iterator[tuple[int, int]]:
    """Yield first row and end of windows that span neither a gap nor a switch.

    Parameters
    ----------
    time : ndarray, shape (n,)
        In s.
    modes : ndarray of int or None, shape (n,)
        In force at every row.
    length : float
        In s.
    """
    steps = np.diff(time)
    breaks = steps > _GAP * float(np.median(steps))
    if modes is not None:
        breaks |= np.diff(modes) != 0
    edges = [0, *(np.flatnonzero(breaks) + 1).tolist(), len(time)]
    for begin, end in itertools.pairwise(edges):
        count = max(int((time[end - 1] - time[begin]) / length), 1)
        cuts = np.linspace(begin, end, count + 1).astype(int).tolist()
        for first, last in itertools.pairwise(cuts):
            if last - first >= FEWEST_ROWS:
                yield first, last


def stiffness_of(
    time: Array, deflection: Array, force: Array, spans: list[tuple[int, int]]
) -> list[Window]:
    """Estimate ``F = c + k x + b x'`` in every window.

    The lower end is that of the regression of force on deflection, which noise of the deflection
    draws towards zero; the upper end is that of the reverse regression, which noise of the force
    draws away (Frisch 1934). Correlation of the errors widens both.

    Parameters
    ----------
    time, deflection, force : ndarray, shape (n,)
        Columns of the log.
    spans : list of (int, int)
        First row and end of every window.
    """
    confidence = 1 - (1 - CONFIDENCE) / max(len(spans), 1)
    velocity = np.gradient(deflection, time)
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
    x, y = (c - basis @ (basis.T @ c) for c in (x, f))
    power, cross = float(x @ x), float(x @ y)
    if power <= 1e-20 or cross == 0.0:
        return Window(first, last, 0.0, -math.inf, math.inf)
    k = cross / power
    rest = y - k * x
    degrees = len(x) - 3
    alike = float(rest[1:] @ rest[:-1]) / max(float(rest @ rest), 1e-300)
    inflation = (1 + max(alike, 0.0)) / max(1 - alike, 1e-3)
    error = math.sqrt(float(rest @ rest) / degrees / power * inflation)
    half = student_quantile(degrees, confidence) * error
    reverse = float(y @ y) / cross
    return Window(first, last, k, min(k, reverse) - half, max(k, reverse) + half)
