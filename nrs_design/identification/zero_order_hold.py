"""Delayed commands with zero-order hold, and the response of linear models.

Exact for any steps of time and any delay: a command that acts within a step parts it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np

from nrs_design.identification.numeric import Array, Rows
from nrs_design.models.contact.relaxation import run_first_order

# Least distance of two poles.
_LEAST_DISTANCE = 1e-4


@dataclass(frozen=True)
class HeldCommand:
    """A delayed command: constant between the times of a grid that contains all samples."""

    grid: Array  # Shape (m,). Times in s.
    command: Array  # Shape (m - 1,). From each time to the next.
    samples: Rows  # Shape (n,). Where the samples are in the grid.

    @classmethod
    def build(cls, time: Array, command: Array, delay: float) -> Self:
        """Hold every command from its sample to the next, and let it act a delay in s later.

        The first one was there before; the last one acts at no sample.
        """
        acts = time + delay
        inner_times = acts[(acts > time[0]) & (acts < time[-1])]
        grid = np.union1d(time, inner_times)
        index = np.searchsorted(acts, grid[:-1], side="right") - 1
        return cls(grid, command[np.maximum(index, 0)], np.searchsorted(grid, time))

    @cached_property
    def steps(self) -> Array:
        """Lengths of the intervals in s, shape (m - 1,)."""
        return np.diff(self.grid)


@dataclass(frozen=True, slots=True)
class Lags:
    """A linear model of unit gain as a sum of first-order lags."""

    times: tuple[complex, ...]  # Time constants in s
    shares: tuple[complex, ...]  # Factors with the sum 1

    @classmethod
    def first_order(cls, time_constant: float) -> Self:
        """Return ``1/(tau s + 1)``."""
        return cls((time_constant,), (1.0,))

    @classmethod
    def second_order(cls, time: float, damping: float) -> Self:
        """Return ``1/(T^2 s^2 + 2 zeta T s + 1)``; equal poles are taken apart a little."""
        if abs(damping - 1) < _LEAST_DISTANCE:
            damping = 1 + _LEAST_DISTANCE
        root = np.sqrt(complex(damping**2 - 1))
        p, q = (1 / time) * (-damping + root), (1 / time) * (-damping - root)
        return cls(
            (complex(-1 / p), complex(-1 / q)), (complex(-q / (p - q)), complex(p / (p - q)))
        )

    def velocity(self, zoh: HeldCommand, inputs: Array) -> Array:
        """Return the output of the model from rest, shape (m,), to m - 1 held inputs."""
        parts = (s * _lag(t, zoh.steps, inputs) for t, s in self._pairs())
        return np.asarray(sum(parts).real, float)

    def angle(self, zoh: HeldCommand, inputs: Array) -> Array:
        """Return the integral of the output, from zero; parameters as for `velocity`."""
        parts = (s * _traveled(t, zoh.steps, inputs) for t, s in self._pairs())
        return np.asarray(sum(parts).real, float)

    def free(self, time: Array, *, angle: bool) -> Array:
        """Return the outputs that follow from initial states alone, shape (n, p).

        An angle is the integral of the model's output, and may begin anywhere.
        """
        ends = [np.exp(-(time - time[0]) / t) for t, _ in self._pairs()]
        decays = [part for end in ends for part in (end.real, end.imag) if part.any()]
        return np.column_stack([np.ones_like(time), *decays] if angle else decays)

    def _pairs(self) -> Iterator[tuple[complex, complex]]:
        """Yield time constants and shares; for a conjugate pair, one with twice its share.

        Only the real part of the sum counts, and it is the same.
        """
        if self.times[0].imag:
            yield self.times[0], 2 * self.shares[0]
        else:
            yield from zip(self.times, self.shares, strict=True)


def _lag(time_constant: complex, steps: Array, inputs: Array) -> Any:
    """Return the output of one lag from rest, exact for held inputs."""
    a = _decay(time_constant, steps)
    return run_first_order(a, (1 - a) * inputs.astype(a.dtype))


def _traveled(time_constant: complex, steps: Array, inputs: Array) -> Any:
    """Return the integral of the output of one lag from rest, exact for held inputs."""
    output = _lag(time_constant, steps, inputs)
    a = _decay(time_constant, steps)
    travel = inputs * steps + _real(time_constant) * (1 - a) * (output[:-1] - inputs)
    return np.concatenate([np.zeros(1, travel.dtype), np.cumsum(travel)])


def _decay(time_constant: complex, steps: Array) -> Any:
    return np.exp(-steps / _real(time_constant))


def _real(time_constant: complex) -> complex:
    """Return a float for a real time constant, so that arrays stay real."""
    return time_constant if np.imag(time_constant) else float(np.real(time_constant))
