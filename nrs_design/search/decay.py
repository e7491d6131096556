"""The largest decay rate that a search can show (untrusted).

A position s in [0, 1) stands for the rate: 0 is mere stability, 1 the rate of the slowest mode,
which no common function can exceed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from math import inf, sqrt
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from nrs_design.proof.mode import Time
from nrs_design.search.lmi import decreases
from nrs_design.search.rounding import claims, rate_at
from nrs_design.work import Allowance, NotAffordableError

# A position is bracketed to this share of itself, or given up as nil below the smallest one.
RESOLUTION = 2.0**-12
SMALLEST = 2.0**-40
# A step goes so far to what is known to be infeasible, at most; and after one that went too far.
FAR, NEAR = 0.75, 0.125

Solution = TypeVar("Solution")


def limit_rate(matrices: NDArray[np.float64], time: Time) -> float:
    """Return the rate of the slowest mode: ``-max Re`` in 1/s, or the largest spectral radius.

    Not a number if the matrices are beyond the range of floating point.
    """
    if not np.isfinite(matrices).all():
        return np.nan
    eigenvalues = np.linalg.eigvals(matrices)
    if time is Time.CONTINUOUS:
        return float(-eigenvalues.real.max())
    return float(np.abs(eigenvalues).max())


def fastest_first(
    solve: Callable[[float, Allowance], Solution | None],
    limit: float,
    time: Time,
    allowance: Allowance,
    *,
    resolution: float = RESOLUTION,
    smallest: float = SMALLEST,
    nearest: float = 1.0,
) -> Iterator[tuple[Solution, Fraction]]:
    """Yield solutions with the rates to claim, from just below the largest one that is found.

    The search for the largest rate takes at most half of what is allowed. `limit` is as
    `limit_rate` gives it; `nearest` as for `nrs_design.search.rounding.claims`.
    """
    half = allowance.part(0.5)
    best = bisect_position(
        lambda s: s if solve(rate_at(s, limit, time), half) is not None else None,
        resolution,
        smallest,
    )
    for claim in claims(best, limit, time, nearest):
        if (solution := solve(float(claim), allowance)) is not None:
            yield solution, claim


def bisect_position(
    shown: Callable[[float], float | None],
    resolution: float = RESOLUTION,
    smallest: float = SMALLEST,
) -> float:
    """Bisect for the largest feasible position; zero if nothing above the smallest one is.

    Feasible positions come first; there, it is told which position is shown as well, perhaps a
    larger one. The largest is bracketed to a share of itself, `resolution`, or to the difference
    `smallest`, whichever is reached first; it ends early when the work is used up.
    """
    low, high = 0.0, 1.0
    while high - low > max(resolution * high, smallest):
        middle = (low + high) / 2
        try:
            found = shown(middle)
        except NotAffordableError:
            break
        low, high = (low, middle) if found is None else (max(middle, min(found, high)), high)
    return low


def climb_position(
    ask: Callable[[float], tuple[float, float] | None],
    start: tuple[float, float],
    resolution: float,
    smallest: float,
) -> float:
    """Climb to the largest feasible position, where each answer takes long and says more than yes.

    An answer is the margin, and the position that was shown, or None; `start` is that of zero. The
    root of the margin is nearly straight until it is nil: the next position is where it would be.
    When the work is used up, it ends early.
    """
    low, high = max(0.0, min(start[1], 1.0)), 1.0
    known, position = [(0.0, sqrt(start[0]))], low
    while high - low > max(resolution * high, smallest):
        try:
            found = ask(position)
        except NotAffordableError:
            break
        if found is None:
            high = position
        else:
            margin, shown = found
            known.append((position, sqrt(margin)))
            low = max(low, position, min(shown, high))
        step = max(resolution * high, smallest)
        if found is None:  # What was shown last is near the largest
            position = min(low + max(step, NEAR * (high - low)), (low + high) / 2)
        else:
            position = min(max(_root(*known[-2:]), low + step), low + FAR * (high - low))
    return low


def _root(first: tuple[float, float], second: tuple[float, float]) -> float:
    """Return where the straight line through two points is nil; nowhere if it rises."""
    (a, f), (b, g) = first, second
    return b + g * (b - a) / (f - g) if f > g else inf


def rate_of(matrices: NDArray[np.float64], Q: NDArray[np.float64], time: Time) -> float:
    """Return the best rate that a given Q shows, by generalized eigenvalues.

    In 1/s; in discrete time, the contraction per step.
    """
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    forms = inverse @ decreases(matrices, Q, time, 0.0) @ inverse.T
    values = np.linalg.eigvalsh(forms)
    if time is Time.CONTINUOUS:
        return float(values[:, 0].min()) / 2
    return float(np.sqrt(max(-values[:, 0].min(), 0.0)))
