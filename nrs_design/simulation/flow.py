"""The flow of a linear system, and the first time at which one of its signals changes its sign.

A step is at most one time constant of the fastest rate. A signal is looked at where a step ends,
and within it where it approaches zero at first and leaves it in the end: there it turns. One that
turns twice within a step may be missed, and one that comes nearer to zero than a tolerance counts
as across.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nrs_design.late import late_function
from nrs_design.models.exponential import expm
from nrs_design.simulation.scenario import Array

# SciPy takes longer to load than many runs take.
brentq = late_function("scipy.optimize", "brentq")

# Degree of the Taylor polynomials within a step.
DEGREE = 18
_POWERS = np.arange(DEGREE + 1.0)
# Steps that are computed at once.
CHUNK = 64


@dataclass(frozen=True)
class Flow:
    """``z' = A z`` with signals that are watched."""

    A: Array  # Shape (n, n). The system.
    # Shape (e, n). Rows of the signals; a signal changes its side beyond its tolerance.
    signals: Array
    tolerances: Array  # Shape (e,). In the units of the signals.
    step: float  # At most so long a step, in s

    @cached_property
    def h(self) -> float:
        """Step in s, at most one time constant of the fastest rate."""
        rate = float(np.abs(np.linalg.eigvals(np.abs(self.A))).max())
        return min(self.step, 1.0 / rate) if rate > 0 else self.step

    @cached_property
    def _rates(self) -> Array:
        """Rows of the rates of the signals, shape (e, n)."""
        return np.asarray(self.signals @ self.A)

    @cached_property
    def _terms(self) -> Array:
        """``(A h)^k / k!`` for k = 0 ... DEGREE, below each other: one product is fast."""
        terms = [np.eye(len(self.A))]
        for k in range(1, DEGREE + 1):
            terms.append(terms[-1] @ (self.A * (self.h / k)))
        return np.concatenate(terms)

    @cached_property
    def _powers(self) -> Array:
        """``exp(A k h)`` for k = 0 ... CHUNK, below each other."""
        E, powers = expm(self.A * self.h), [np.eye(len(self.A))]
        for _ in range(CHUNK):
            powers.append(E @ powers[-1])
        return np.concatenate(powers)

    def advance(self, z: Array, time: float) -> Array:
        """Return ``exp(A t) z`` for a time from zero to h, in s."""
        terms = self._terms.dot(z).reshape(DEGREE + 1, -1)
        return np.asarray(((time / self.h) ** _POWERS).dot(terms))

    def chunk(self, z: Array, count: int) -> Array:
        """Return the states after 0 ... count steps of h; shape (count + 1, n)."""
        n = len(z)
        return np.asarray(self._powers[: (count + 1) * n].dot(z).reshape(-1, n))

    def first_doubtful(self, states: Array, sides: Array) -> int:
        """Return the first step in which a signal may change its side, or how many steps there are.

        States at the ends of the steps, shape (N + 1, n); sides 1 or -1, shape (e,).
        """
        values = states @ self.signals.T * sides + self.tolerances
        rates = states @ self._rates.T * sides
        begin, end, falls, rises = values[:-1], values[1:], rates[:-1], rates[1:]
        # The end tangents of a turning signal intersect at a lower bound.
        turns = (falls < 0) & (rises > 0)
        slopes = np.where(turns, rises - falls, 1.0)
        intersections = np.where(turns, begin - end + rises * self.h, 0.0) / slopes
        lowest = np.minimum(np.minimum(begin, end), begin + falls * intersections)
        doubtful = np.append((lowest <= 0).any(axis=1), True)
        return int(doubtful.argmax())

    def first_crossing(self, z: Array, width: float, sides: Array) -> float | None:
        """Return the first time at which a signal has changed its side, or None.

        From the state z, shape (n,), within `width` s; sides 1 or -1, shape (e,).
        """
        found: float | None = None
        for e, side in enumerate(sides.tolist()):
            time = self._crossing(e, side, z, width)
            if time is not None:
                found = width = time
        return found

    def _crossing(self, e: int, side: float, z: Array, width: float) -> float | None:
        """Return the first time at which one signal is across, within a width."""

        def value(time: float) -> float:
            return float(side * (self.signals[e] @ self.advance(z, time)) + self.tolerances[e])

        def rate(time: float) -> float:
            return float(side * (self._rates[e] @ self.advance(z, time)))

        if value(0.0) <= 0:
            return 0.0
        # Times as accurate as doubles are.
        end = width
        if rate(0.0) < 0 < rate(width):
            end = brentq(rate, 0.0, width, xtol=1e-16)
        return float(brentq(value, 0.0, end, xtol=1e-16)) if value(end) <= 0 else None
