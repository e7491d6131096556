"""The model fitted to the outputs themselves, by output error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.actuator.motor import MotorModel
from nrs_design.identification.datasets.records import ActuatorRecord
from nrs_design.identification.numeric import Array, bic, limited_step
from nrs_design.identification.rounding import rounding_scatter
from nrs_design.identification.statistics import Uncertainty, uncertainty

_STEPS = 60
_CONVERGED = 1e-6
# Of the power of one error: in a valley without an end errors fall no more, parameters go on.
_NO_BETTER = 1e-3
_LARGEST_STEP = 0.5
_HALVINGS = 12
# From so many records on, their spread says how far they agree; before, that of parts of them.
MANY_RECORDS = 5
# Friction is told where it is so many standard errors; where it is among the parameters.
_CLEAR = 4.0
_FRICTION = 2


@dataclass(frozen=True, slots=True, eq=False)
class TimeFit:
    """A motor that fits records best."""

    motor: MotorModel  # With its parameters
    uncertainty: Uncertainty  # Of `MotorModel.parameters`
    errors: Array  # Shape (n,). Measured less fitted, of all records in turn.

    @property
    def tells_friction(self) -> bool:
        """Whether the friction stands out of its standard error."""
        if self.motor.friction is None:
            return False
        return float(self.uncertainty.errors[_FRICTION]) < 1 / _CLEAR

    @property
    def bic(self) -> float:
        """Bayesian information criterion, up to a constant of the records."""
        return bic(self.errors, len(self.motor.parameters))


def fit_in_time(records: Sequence[ActuatorRecord], start: MotorModel) -> TimeFit:
    """Refine a motor in the time domain, its dead time with it.

    The command is held between samples and the velocity is solved exactly. Initial angle and
    velocity of every record are eliminated by linear least squares. If the errors are not white,
    the spread between records, or between parts of few records, goes into the intervals.
    """
    motor, usual = start, min(record.step for record in records)
    errors = [motor.errors(record) for record in records]
    for _ in range(_STEPS):
        slopes = [motor.derivatives(record) for record in records]
        J, error = np.concatenate(slopes), np.concatenate(errors)
        scale = np.ones(J.shape[1])
        scale[-1] = usual
        step = scale * np.linalg.lstsq(J * scale, error, rcond=None)[0]
        limit = np.full(len(step), _LARGEST_STEP)
        limit[-1] = 2 * usual + motor.time_constant / 4
        step = limited_step(step, limit)
        if np.abs(step / scale).max() < _CONVERGED:
            break
        better = _improved(records, motor, step, float(error @ error))
        if better is None:
            break
        motor, errors, left = better
        if left > (1 - _NO_BETTER / len(error)) * float(error @ error):
            break
    else:
        raise DataError(
            "the fit in the time domain does not settle",
            remedy="check the records, or give a ready frequency response",
        )
    slopes = [motor.derivatives(record) for record in records]
    return TimeFit(motor, _uncertainty(records, slopes, errors), np.concatenate(errors))


def _improved(
    records: Sequence[ActuatorRecord], motor: MotorModel, step: Array, power: float
) -> tuple[MotorModel, list[Array], float] | None:
    """Return a motor along a step that fits better, its errors and their power; or None."""
    for halving in range(_HALVINGS):
        tried = motor.with_parameters(motor.parameters + step / 2**halving)
        errors = [tried.errors(record) for record in records]
        found = sum(float(error @ error) for error in errors)
        if np.isfinite(found) and found < power:
            return tried, errors, found
    return None


def _uncertainty(
    records: Sequence[ActuatorRecord], slopes: Sequence[Array], errors: Sequence[Array]
) -> Uncertainty:
    J, starts = np.concatenate(slopes), None
    if len(records) >= MANY_RECORDS:
        starts = np.cumsum([0, *(len(record.time) for record in records[:-1])]).tolist()
    parts = zip(records, slopes, strict=True)
    scatter = np.sum([rounding_scatter(r.output, slope, 1.0) for r, slope in parts], axis=0)
    return uncertainty(J, np.concatenate(errors), starts, scatter)
