"""A delay by least squares, beside the dynamics that it must not be mistaken for."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.delay.models import AbstractFollower, HeldCopy
from nrs_design.identification.least_squares import search
from nrs_design.identification.numeric import Array, Rows, beyond, bic, column_sizes
from nrs_design.identification.statistics import Uncertainty, uncertainty

# So far from where columns are most alike, in samples, a whole number of them is sought.
_AROUND = 8
_DIFFERENCE = 1e-4
# Errors of this part of the power are rounding.
EXACT = 1e-24


@dataclass(frozen=True, slots=True, eq=False)
class DelayFit:
    """One model with the delay that fits best."""

    follower: AbstractFollower  # The model
    delay: float  # In s
    # Of the delay in samples, first, and of the logarithms of the other parameters.
    uncertainty: Uncertainty
    # sensitivity, errors: shape (m,). Change of the output by one sample of delay, and measured
    # less fitted.
    sensitivity: Array
    errors: Array
    # Shape (m,). Samples that were fitted: those that the command before the record cannot reach.
    rows: Rows
    seen: Array  # Shape (m,). What was measured.
    fitted: Array  # Shape (n,). Output of the model.
    # Shape (p,). Gain, offset and initial state: factors of the columns of the model.
    solution: Array

    @property
    def gain(self) -> float:
        """Output over input."""
        return float(self.solution[0])

    def output(self, record: SignalRecord, delay: float) -> Array:
        """Return the output of the model with another delay in s, shape (n,)."""
        return np.asarray(self.follower.columns(record, delay) @ self.solution, float)

    @property
    def bic(self) -> float:
        """Bayesian information criterion, up to a constant of the record."""
        least = EXACT * float(self.seen @ self.seen)
        return bic(self.errors, 1 + len(self.follower.shape), least)


def fit_delay(
    record: SignalRecord, follower: AbstractFollower, delay: float, rows: Rows
) -> DelayFit:
    """Refine delay in s and shape of a model by least squares over the rows that count.

    Gain, offset and initial state are eliminated everywhere.
    """

    def shaped(x: Array) -> tuple[AbstractFollower, float]:
        return replace(follower, shape=tuple(x[1:].tolist())), float(x[0]) * record.step

    def errors(x: Array) -> Array:
        return errors_at(record, *shaped(x), rows)

    def sensitivities(x: Array) -> Array:
        steps = _DIFFERENCE * np.eye(len(x))
        changes = [(errors(x - h) - errors(x + h)) / (2 * _DIFFERENCE) for h in steps]
        return np.column_stack(changes)

    scale = np.array([1.0, *[0.5] * len(follower.shape)])
    start = np.array([delay / record.step, *follower.shape])
    x, _ = search(errors, sensitivities, start, scale)
    error = errors(x)
    J, (model, late) = sensitivities(x), shaped(x)
    columns = model.columns(record, late)
    solution = solve(columns[rows], record.seen[rows])
    fitted, known = columns @ solution, uncertainty(J, error)
    return DelayFit(model, late, known, J[:, 0], error, rows, record.seen[rows], fitted, solution)


def fit_held(record: SignalRecord, delay: float, rows: Rows) -> DelayFit:
    """Find the whole number of samples by which a copy is late, near a delay in s."""
    follower, near = HeldCopy(), round(delay / record.step)

    def missed(late: int) -> float:
        error = errors_at(record, follower, late * record.step, rows)
        return float(error @ error)

    best = min(range(near - _AROUND, near + _AROUND + 1), key=lambda k: (missed(k), abs(k - near)))
    before, at, after = (follower.columns(record, (best + k) * record.step) for k in (-1, 0, 1))
    solution = solve(at[rows], record.seen[rows])
    fitted = at @ solution
    slope = (after - before)[rows] @ solution / 2
    error = record.seen[rows] - fitted[rows]
    known = uncertainty(slope[:, None], error)
    return DelayFit(
        follower, best * record.step, known, slope, error, rows, record.seen[rows], fitted, solution
    )


def solve(columns: Array, seen: Array) -> Array:
    """Return the factors of the columns, shape (p,), that fit best, whatever their units."""
    sizes = column_sizes(columns)
    found = np.linalg.lstsq(columns / sizes, seen, rcond=None)[0]
    return np.asarray(found / sizes, float)


def errors_at(record: SignalRecord, follower: AbstractFollower, delay: float, rows: Rows) -> Array:
    """Return measured less fitted output, with the best gain, offset and start."""
    columns = follower.columns(record, delay)[rows]
    basis, _ = np.linalg.qr(columns / column_sizes(columns))
    return beyond(basis, record.seen[rows])
