"""A velocity model with Coulomb friction (thesis 4.1) and dead time, fitted by least squares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.identification.actuator.motor import MotorModel
from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.errors import DataError
from nrs_design.identification.numeric import TINY, Array, bic, search
from nrs_design.identification.rounding import rounding_scatter
from nrs_design.identification.statistics import (
    Estimate,
    Uncertainty,
    joint_level,
    student_quantile,
    uncertainty,
)

# Grid of a first search: number of time constants, and dead times in samples.
_TIME_CONSTANTS = 14
_DELAYS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
# Longest dead time or time constant, as a part of a record.
_LONGEST = 0.1
# Largest independent part of the power at which two effects are indistinguishable.
_ALIKE = 1e-3
# Least ratio of gain or friction to its standard error.
_CLEAR = 4.0
# Ratio of squared errors to the least ones that is nearly as good.
_NEARLY = 4.0
# Least number of records whose scatter gives the covariance; fewer records are divided into
# batches.
MANY_RECORDS = 5
# Index of the friction among the parameters.
_FRICTION = 2
# A log does not say when within a sample a command began.
DEAD_TIME_NOTE = (
    "counted from the row in which a command first appears; the true dead time is up to a sample "
    "longer"
)


def longest_delay(records: Sequence[SignalRecord]) -> float:
    """Return the longest dead time, or time constant, that is looked for, in s."""
    return _LONGEST * max(float(record.time[-1]) for record in records)


def scan_motor(records: Sequence[SignalRecord]) -> MotorModel:
    """Return the best motor of a grid of time constants and dead times.

    Gain and friction are linear in the output for every command.
    """
    candidates = [(*_solve(records, *pair), *pair) for pair in _grid(records)]
    best = min(candidates, key=lambda item: item[0])
    positive = [item for item in candidates if item[1][0] > _CLEAR * item[2][0]]
    against = best[1][0] < -_CLEAR * best[2][0]
    if not positive and not against:
        raise DataError(
            "the output does not follow the command",
            remedy="check that both columns belong to one motor and one clock",
        )
    # A poor model may invert the sign: the columns differ in sign if no other model fits nearly.
    if not positive or (against and min(item[0] for item in positive) > _NEARLY * best[0]):
        raise DataError(
            "the output moves against the command: their signs are opposite",
            remedy="turn the sign of one column, or swap the leads of the sensor",
        )
    _, solution, errors, tau, delay = min(positive, key=lambda item: item[0])
    gain = float(solution[0])
    clear = solution[1] > _CLEAR * errors[1] and tells_friction(records, tau, delay)
    return MotorModel(gain, tau, float(solution[1]) / gain if clear else None, delay)


def tells_friction(records: Sequence[SignalRecord], tau: float, delay: float) -> bool:
    """Tell whether friction differs from a smaller gain; under one step it does not.

    Time constant and dead time are in s.
    """
    return _differ(np.concatenate([_regressors(record, tau, delay)[0] for record in records]))


def _differ(X: Array) -> bool:
    """Tell whether the columns of command and friction are linearly independent."""
    power = np.einsum("ij,ij->j", X, X)
    if not power.all():
        return False
    return float(X[:, 0] @ X[:, 1]) ** 2 < (1 - _ALIKE) * float(power[0] * power[1])


def _grid(records: Sequence[SignalRecord]) -> Iterator[tuple[float, float]]:
    step = min(record.step for record in records)
    longest = longest_delay(records)
    taus = np.geomspace(step, max(longest, 4 * step), _TIME_CONSTANTS)
    delays = [d * step for d in _DELAYS if d * step <= longest]
    return ((float(tau), delay) for delay in delays for tau in taus)


def _solve(records: Sequence[SignalRecord], tau: float, delay: float) -> tuple[float, Array, Array]:
    """Return squared errors, gain and gain times friction, and their standard errors."""
    rows = [_regressors(record, tau, delay) for record in records]
    X = np.concatenate([x for x, _ in rows])
    y = np.concatenate([y for _, y in rows])
    if not _differ(X):
        # Else a friction above the command would pass for a motor that is wired the other way.
        X = X * [1.0, 0.0]
    solution = np.linalg.lstsq(X, y, rcond=None)[0]
    residuals = y - X @ solution
    power = float(residuals @ residuals)
    inverse = np.linalg.pinv(X.T @ X)
    deviations = np.sqrt(np.diag(inverse) * power / max(len(y) - 2, 1))
    return power, np.asarray(solution, float), np.maximum(deviations, TINY)


def _regressors(record: SignalRecord, tau: float, delay: float) -> tuple[Array, Array]:
    """Return the outputs of a unit gain for command and friction, (n, 2), and the measured one."""
    motor = MotorModel(1.0, tau, None, delay)
    zoh, _ = motor.hold(record)
    against = replace(zoh, command=-np.sign(motor.lags.velocity(zoh, zoh.command)[:-1]))
    columns = [motor.forced(record, inputs, None) for inputs in (zoh, against)]
    outputs = motor.remove_initial_state(record, np.column_stack([*columns, record.output]))
    return outputs[:, :2], outputs[:, 2]


@dataclass(frozen=True, slots=True, eq=False)
class ActuatorFit:
    """``tau v' + v = gain (delta(t - D) - friction sign v)``."""

    gain: Estimate  # In rad/s for each unit of the command
    time_constant: Estimate  # In s
    # Coulomb friction in units of the command; None where the data cannot tell.
    friction: Estimate | None
    uncertainty: Uncertainty  # For `MotorModel.parameters`
    dead_time: Estimate | None  # D in s; None if not determined
    motor: MotorModel  # The same without intervals
    errors: Array  # Shape (n,). Measured less fitted, of all records in turn.

    @property
    def tells_friction(self) -> bool:
        """Whether the friction stands out of its standard error."""
        return self.friction is not None and self.uncertainty.errors[_FRICTION] < 1 / _CLEAR

    @property
    def bic(self) -> float:
        """Bayesian information criterion, up to a constant of the records."""
        return bic(self.errors, len(self.uncertainty.covariance))

    @property
    def ranges(self) -> tuple[Estimate, Estimate]:
        """Gain and time constant between ends that hold with 95 % for both together."""
        logarithms = np.log([self.gain.value, self.time_constant.value])
        fit_uncertainty = replace(self.uncertainty, covariance=self.uncertainty.covariance[:2, :2])
        gain, time_constant = fit_uncertainty.estimates(logarithms, joint_level(2))
        return gain, time_constant


def fit_in_time(records: Sequence[SignalRecord], start: MotorModel) -> ActuatorFit:
    """Refine a motor in the time domain, its dead time with it.

    The command is held between samples and the velocity is solved exactly. Initial angle and
    velocity of every record are eliminated by linear least squares. If the errors are not white,
    the spread between records, or between parts of few records, goes into the intervals.
    """

    def errors(x: Array) -> Array:
        motor = start.replace_parameters(x)
        return np.concatenate([motor.errors(record) for record in records])

    def slopes(x: Array) -> Array:
        motor = start.replace_parameters(x)
        return np.concatenate([motor.derivatives(record) for record in records])

    scale = np.ones(len(start.parameters))
    scale[-1] = min(record.step for record in records)
    x, settled = search(errors, slopes, start.parameters, scale)
    if not settled:
        raise DataError(
            "the fit in the time domain does not settle",
            remedy="check the records, or give livelier ones",
        )
    motor, left = start.replace_parameters(x), errors(x)
    fit_uncertainty = _uncertainty(records, slopes(x), left)
    gain, time_constant, *friction = fit_uncertainty.estimates(x)[:-1]
    return ActuatorFit(
        gain=gain,
        time_constant=time_constant,
        friction=friction[0] if friction else None,
        uncertainty=fit_uncertainty,
        dead_time=_dead_time(motor.delay, fit_uncertainty, longest_delay(records)),
        motor=motor,
        errors=left,
    )


def _dead_time(delay: float, fit_uncertainty: Uncertainty, longest: float) -> Estimate | None:
    """Return a dead time, never below zero; None for one that may be beyond the longest."""
    half = student_quantile(fit_uncertainty.degrees) * float(fit_uncertainty.errors[-1])
    ends = (delay, delay - half, delay + half)
    return Estimate(*(max(end, 0.0) for end in ends)) if ends[-1] <= longest else None


def _uncertainty(records: Sequence[SignalRecord], J: Array, errors: Array) -> Uncertainty:
    ends = np.cumsum([0, *(len(record.time) for record in records)]).tolist()
    starts = ends[:-1] if len(records) >= MANY_RECORDS else None
    parts = zip(records, np.split(J, ends[1:-1]), strict=True)
    scatter = np.sum([rounding_scatter(r.output, slope, 1.0) for r, slope in parts], axis=0)
    return uncertainty(J, errors, starts, scatter)
