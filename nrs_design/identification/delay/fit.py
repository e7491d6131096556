"""Least-squares fits of a delay together with possible dynamics."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from math import exp

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.numeric import Array, Rows, bic, column_sizes, reject, search
from nrs_design.identification.statistics import Uncertainty, uncertainty
from nrs_design.identification.zero_order_hold import HeldCommand, Lags

# Half width of the search about the peak of the correlation, in samples.
_COPY_RANGE = 8
_DIFFERENCE = 1e-4
# Errors of this part of the power are rounding.
EXACT = 1e-24


@dataclass(frozen=True)
class AbstractFollower(ABC):
    """A model of the response to a command; gain, offset and initial state are linear."""

    shape: tuple[float, ...] = ()  # Logarithms of its other parameters
    name: str = "a copy"

    @abstractmethod
    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return the columns that the output is a combination of, (n, p), at a delay in s."""


class SmoothCopy(AbstractFollower):
    """The command, later; smooth between samples."""

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return the command and a constant."""
        from scipy.interpolate import CubicSpline

        times = np.clip(record.time - delay, record.time[0], record.time[-1])
        spline = CubicSpline(record.time, record.command)
        return np.column_stack([spline(times), np.ones_like(times)])


class HeldCopy(AbstractFollower):
    """The command, whole samples later; its values between samples are unknown."""

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return the command and a constant."""
        rows = np.arange(len(record.time)) - round(delay / record.step)
        index = np.clip(rows, 0, len(record.time) - 1)
        return np.column_stack([record.command[index], np.ones(len(index))])


@dataclass(frozen=True)
class Lagged(AbstractFollower):
    """Lags of the command that is held between samples, or their integral."""

    lags: Callable[..., Lags] = Lags.first_order  # By the parameters
    angle: bool = False  # Integrate the lag, as for the angle of a velocity-controlled motor

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return output, constant (a drift for an integral) and initial states."""
        lags, zoh = self.lags(*map(exp, self.shape)), _hold(record, delay)
        output = (lags.angle if self.angle else lags.velocity)(zoh, zoh.command)[zoh.samples]
        constant = record.time if self.angle else np.ones_like(output)
        return np.column_stack([output, constant, lags.free(record.time, angle=self.angle)])


@lru_cache(maxsize=32)
def _hold(record: SignalRecord, delay: float) -> HeldCommand:
    """Return the delayed command; several shapes are tried at each delay."""
    return HeldCommand.build(record.time, record.command, delay)


@dataclass(frozen=True, slots=True, eq=False)
class DelayFit:
    """One model with the delay that fits best."""

    record: SignalRecord  # The data, n samples
    follower: AbstractFollower  # The model
    delay: float  # In s
    # For the delay in samples, then the logarithms of the other parameters.
    uncertainty: Uncertainty
    # sensitivity, errors: shape (m,). Change of the output by one sample of delay, and measured
    # less fitted.
    sensitivity: Array
    errors: Array
    # Shape (m,). Samples that were fitted: those that the command before the record cannot reach.
    rows: Rows
    fitted: Array  # Shape (n,). Output of the model.
    # Shape (p,). Gain, offset and initial state: factors of the columns of the model.
    solution: Array

    @property
    def gain(self) -> float:
        """Output over input."""
        return float(self.solution[0])

    @property
    def samples(self) -> float:
        """The delay in samples of the record."""
        return self.delay / self.record.step

    @property
    def measured(self) -> Array:
        """Measured output in the fitted samples, shape (m,)."""
        return self.record.output[self.rows]

    @property
    def missed_part(self) -> float:
        """Root mean square of the errors over that of the motion."""
        motion = np.linalg.norm(self.measured - self.measured.mean())
        return float(np.linalg.norm(self.errors) / motion)

    def output(self, samples: float) -> Array:
        """Return the output of the model with another delay in samples, shape (n,)."""
        columns = self.follower.columns(self.record, samples * self.record.step)
        return np.asarray(columns @ self.solution, float)

    @property
    def bic(self) -> float:
        """Bayesian information criterion, up to a constant of the record."""
        floor = EXACT * float(self.measured @ self.measured)
        return bic(self.errors, 1 + len(self.follower.shape), floor)


def fit_delay(
    record: SignalRecord, follower: AbstractFollower, delay: float, rows: Rows
) -> DelayFit:
    """Refine delay in s and shape of a model by least squares over the given rows.

    Gain, offset and initial state are eliminated everywhere.
    """

    def shaped(x: Array) -> tuple[AbstractFollower, float]:
        return replace(follower, shape=tuple(x[1:].tolist())), float(x[0]) * record.step

    def errors(x: Array) -> Array:
        return fit_errors(record, *shaped(x), rows)

    def sensitivities(x: Array) -> Array:
        steps = _DIFFERENCE * np.eye(len(x))
        changes = [(errors(x - h) - errors(x + h)) / (2 * _DIFFERENCE) for h in steps]
        return np.column_stack(changes)

    scale = np.array([1.0, *[0.5] * len(follower.shape)])
    start = np.array([delay / record.step, *follower.shape])
    x, _ = search(errors, sensitivities, start, scale)
    error, J, (model, best_delay) = errors(x), sensitivities(x), shaped(x)
    fitted, solution = _solve(record, model.columns(record, best_delay), rows)
    known = uncertainty(J, error)
    return DelayFit(record, model, best_delay, known, J[:, 0], error, rows, fitted, solution)


def fit_held(record: SignalRecord, delay: float, rows: Rows) -> DelayFit:
    """Fit a delayed copy with an integer number of samples, near a delay in s."""
    follower, start = HeldCopy(), round(delay / record.step)

    def key(samples: int) -> tuple[float, int]:
        error = fit_errors(record, follower, samples * record.step, rows)
        return float(error @ error), abs(samples - start)

    best = min(range(start - _COPY_RANGE, start + _COPY_RANGE + 1), key=key)
    before, center, after = (follower.columns(record, (best + k) * record.step) for k in (-1, 0, 1))
    fitted, solution = _solve(record, center, rows)
    slope = (after - before)[rows] @ solution / 2
    error = record.output[rows] - fitted[rows]
    known, best_delay = uncertainty(slope[:, None], error), best * record.step
    return DelayFit(record, follower, best_delay, known, slope, error, rows, fitted, solution)


def _solve(record: SignalRecord, columns: Array, rows: Rows) -> tuple[Array, Array]:
    """Return the best output of a model in all samples, and the factors of its columns."""
    sizes = column_sizes(columns[rows])
    scaled = np.linalg.lstsq(columns[rows] / sizes, record.output[rows], rcond=None)[0]
    solution = np.asarray(scaled / sizes, float)
    return columns @ solution, solution


def fit_errors(record: SignalRecord, follower: AbstractFollower, delay: float, rows: Rows) -> Array:
    """Return measured less fitted output, with the best gain, offset and start."""
    columns = follower.columns(record, delay)[rows]
    basis, _ = np.linalg.qr(columns / column_sizes(columns))
    return reject(basis, record.output[rows])
