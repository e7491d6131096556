"""The flow of a linear system, and the first sign change of its signals: none is missed.

Over a step h the signal ``g = c exp(A t) z`` is its Taylor polynomial of degree K, up to

    |c A^(K+1)| exp(|A| h) |z| h^(K+1)/(K+1)!        (entry by entry, so nothing is estimated)

and a polynomial lies between its smallest and its largest Bernstein coefficient. Where these, with
that remainder, stay on one side, so does the signal. Where the coefficients change their sign once,
there is one crossing; otherwise the step is halved. What is not covered is the rounding of double
precision, and a signal that comes nearer to its threshold than a tolerance counts as across.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from nrs_design.models.exponential import expm
from nrs_design.simulation.scenario import Array

DEGREE = 14
# Steps that are computed at once.
CHUNK = 64
# Largest number of halvings of a step; a signal still at its threshold then counts as across.
HALVINGS = 40
_ROUNDS = 60


_EACH = range(DEGREE + 1)
_POWERS = np.array(_EACH, dtype=float)
# From coefficients in powers on [0, 1] to those of Bernstein.
BERNSTEIN = np.array([[math.comb(i, k) / math.comb(DEGREE, k) for k in _EACH] for i in _EACH])


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
    def _terms(self) -> Array:
        """``(A h)^k / k!`` for k = 0 ... K; shape (K + 1, n, n)."""
        n = len(self.A)
        terms: Array = np.empty((DEGREE + 1, n, n))
        terms[0] = np.eye(n)
        for k in range(1, DEGREE + 1):
            terms[k] = terms[k - 1] @ (self.A * (self.h / k))
        return terms

    @cached_property
    def powers(self) -> Array:
        """``exp(A k h)`` for k = 0 ... CHUNK; shape (CHUNK + 1, n, n)."""
        E = expm(self.A * self.h)
        powers: Array = np.empty((CHUNK + 1, *E.shape))
        powers[0] = np.eye(len(E))
        for k in range(CHUNK):
            powers[k + 1] = E @ powers[k]
        return powers

    @cached_property
    def _rows(self) -> Array:
        """From a state to the Taylor coefficients of the signals over h; (e, K + 1, n)."""
        return np.asarray(np.einsum("en,knm->ekm", self.signals, self._terms))

    @cached_property
    def _bernstein_rows(self) -> Array:
        """From a state to the Bernstein coefficients of the signals over h; (n, e (K + 1))."""
        rows = np.einsum("ik,ekm->eim", BERNSTEIN, self._rows)
        return np.ascontiguousarray(rows.reshape(-1, len(self.A)).T)

    @cached_property
    def _remainder(self) -> Array:
        """From the size of a state to the remainder over h; shape (e, n)."""
        last = np.abs(self._rows[:, -1] @ self.A) * (self.h / (DEGREE + 1))
        return np.asarray(last @ expm(np.abs(self.A) * self.h))

    def after(self, z: Array, time: float) -> Array:
        """Return ``exp(A t) z`` for a time from zero to h."""
        if not time:
            return z
        # Below each other: one product is faster than many small ones.
        terms = self._terms.reshape(-1, len(z)).dot(z).reshape(DEGREE + 1, -1)
        return np.asarray(((time / self.h) ** _POWERS).dot(terms))

    def chunk(self, z: Array, count: int) -> Array:
        """Return the states after 0 ... count steps of h; shape (count + 1, n)."""
        n = len(z)
        return np.asarray(self.powers[: count + 1].reshape(-1, n).dot(z).reshape(-1, n))

    def first_doubtful(self, states: Array, sides: Array) -> int:
        """Return the first step in which a signal may change its side, or how many steps there are.

        States at the beginnings of the steps, shape (N, n); sides 1 or -1, shape (e,).
        """
        e = len(sides)
        coefficients = (states @ self._bernstein_rows).reshape(len(states), e, DEGREE + 1)
        coefficients *= sides[:, None]
        # Lower bounds on the distances of the signals from zero.
        lowest = coefficients.min(axis=2) + self.tolerances
        doubtful = (lowest <= np.abs(states) @ self._remainder.T).any(axis=1)
        first = int(doubtful.argmax())
        return first if doubtful[first] else len(states)

    def first_crossing(self, z: Array, width: float, sides: Array) -> float | None:
        """Return the first time at which a signal has changed its side, or None.

        From the state z, shape (n,), within `width` s; sides 1 or -1, shape (e,).
        """
        found: float | None = None
        for e, side in enumerate(sides.tolist()):
            time = self._crossing(e, side, z, width)
            if time is not None:
                found, width = time, time
        return found

    def _crossing(self, e: int, side: float, z: Array, width: float) -> float | None:
        """Return the first time at which one signal is across, within a width."""
        # Parts that are still to be looked at, the earliest last: begin, width, halvings.
        parts = [(0.0, width, 0)]
        while parts:
            begin, length, halved = parts.pop()
            start = self.after(z, begin)
            share = length / self.h
            taylor = side * (self._rows[e] @ start) * share**_POWERS
            taylor[0] += self.tolerances[e]
            rest = float(self._remainder[e] @ np.abs(start)) * share ** (DEGREE + 1)
            coefficients = BERNSTEIN @ taylor
            if coefficients.min() > rest:
                continue
            if coefficients[0] <= 0:
                return begin
            signs = np.sign(coefficients[np.abs(coefficients) > rest])
            once = np.count_nonzero(np.diff(signs)) == 1 and coefficients[-1] < -rest
            if once and np.all(np.abs(coefficients) > rest):
                return begin + length * _root(taylor)
            if halved == HALVINGS:
                return begin
            half = length / 2
            parts += [(begin + half, half, halved + 1), (begin, half, halved + 1)]
        return None


def _root(taylor: Array) -> float:
    """Return the one root in [0, 1] of a polynomial that falls through zero there."""
    coefficients = taylor[::-1].tolist()
    low, high, s = 0.0, 1.0, 0.5
    for _ in range(_ROUNDS):
        value = slope = 0.0
        for c in coefficients:
            slope = slope * s + value
            value = value * s + c
        low, high = (s, high) if value > 0 else (low, s)
        step = s - value / slope if slope else low
        new = step if low < step < high else (low + high) / 2
        if abs(new - s) <= 1e-16 or high - low <= 1e-16:
            return new
        s = new
    return s
