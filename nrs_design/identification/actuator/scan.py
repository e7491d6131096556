"""Where a fit in time begins: a scan over time constant and dead time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.actuator.motor import MotorModel
from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.numeric import TINY, Array

_TIME_CONSTANTS = 14
# In samples.
_DELAYS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
# Longest dead time or time constant, as a part of a record.
_LONGEST = 0.1
# Largest independent part of the power at which two effects are indistinguishable.
_ALIKE = 1e-3
# Least ratio of gain or friction to its standard error.
_CLEAR = 4.0
# Squared errors up to so many times the least are nearly as good.
_NEARLY = 4.0


def longest_delay(records: Sequence[SignalRecord]) -> float:
    """Return the longest dead time, or time constant, that is looked for, in s."""
    return _LONGEST * max(float(record.time[-1]) for record in records)


def scan_motor(records: Sequence[SignalRecord]) -> MotorModel:
    """Return the best of many motors; whatever the command is, gain and friction are linear."""
    tried = [(*_solve(records, *pair), *pair) for pair in _grid(records)]
    best = min(tried, key=lambda item: item[0])
    along = [item for item in tried if item[1][0] > _CLEAR * item[2][0]]
    against = best[1][0] < -_CLEAR * best[2][0]
    if not along and not against:
        raise DataError(
            "the output does not follow the command",
            remedy="check that both columns belong to one motor and one clock",
        )
    # A poor model may invert the sign: the columns differ in sign if no other model fits nearly.
    if not along or (against and min(item[0] for item in along) > _NEARLY * best[0]):
        raise DataError(
            "the output moves against the command: their signs are opposite",
            remedy="turn the sign of one column, or swap the leads of the sensor",
        )
    _, solution, errors, tau, delay = min(along, key=lambda item: item[0])
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
    rest = y - X @ solution
    power = float(rest @ rest)
    inverse = np.linalg.pinv(X.T @ X)
    spread = np.sqrt(np.diag(inverse) * power / max(len(y) - 2, 1))
    return power, np.asarray(solution, float), np.maximum(spread, TINY)


def _regressors(record: SignalRecord, tau: float, delay: float) -> tuple[Array, Array]:
    """Return the outputs of a unit gain for command and friction, (n, 2), and the measured one."""
    motor = MotorModel(1.0, tau, None, delay)
    held, _ = motor.hold(record)
    against = replace(held, command=-np.sign(motor.lags.velocity(held, held.command)[:-1]))
    columns = [motor.forced(record, inputs, None) for inputs in (held, against)]
    both = motor.beyond_start(record, np.column_stack([*columns, record.output]))
    return both[:, :2], both[:, 2]
