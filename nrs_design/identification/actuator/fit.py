"""A velocity model with Coulomb friction (thesis 4.1) and dead time, fitted by least squares."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.actuator.motor import MotorModel
from nrs_design.identification.actuator.scan import longest_delay
from nrs_design.identification.datasets.records import FrequencyResponse, SignalRecord
from nrs_design.identification.numeric import Array, Complex, bic, search
from nrs_design.identification.rounding import rounding_scatter
from nrs_design.identification.statistics import (
    Estimate,
    Uncertainty,
    joint_level,
    student_quantile,
    uncertainty,
)

# From this number of records on, the covariance comes from their spread; below, from parts of them.
MANY_RECORDS = 5
# Least ratio of the friction to its standard error, and its index among the parameters.
_CLEAR = 4.0
_FRICTION = 2
_FEWEST_FREQUENCIES = 3
# A log does not say when within a sample a command began.
FROM_THE_ROW = (
    "counted from the row that first holds a command; one that began before it, by up to a sample, "
    "is later by as much"
)


@dataclass(frozen=True, slots=True, eq=False)
class ActuatorFit:
    """``tau v' + v = gain (delta(t - D) - friction sign v)``."""

    method: str  # Method of the fit
    gain: Estimate  # In rad/s for each unit of the command
    time_constant: Estimate  # In s
    # Coulomb friction in units of the command; None where the data cannot tell.
    friction: Estimate | None
    uncertainty: Uncertainty  # For `MotorModel.parameters`, or the logarithms of the first two
    dead_time: Estimate | None = None  # D in s; None if assumed zero or not determined
    # Motor fitted in time; None for a fit in the frequency domain.
    motor: MotorModel | None = None
    # Shape (n,). Measured less fitted, of all records in turn.
    errors: Array = field(default_factory=lambda: np.empty(0))

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
        known = replace(self.uncertainty, covariance=self.uncertainty.covariance[:2, :2])
        gain, time_constant = known.estimates(logarithms, joint_level(2))
        return gain, time_constant

    def response(self, frequency: Array) -> Complex:
        """Return velocity over command without friction, in rad/s per unit, at rad/s."""
        late = 0.0 if self.motor is None else self.motor.delay
        s = 1j * frequency
        lag = self.gain.value / (1 + s * self.time_constant.value)
        return np.asarray(lag * np.exp(-s * late))


def fit_in_time(records: Sequence[SignalRecord], start: MotorModel) -> ActuatorFit:
    """Refine a motor in the time domain, its dead time with it.

    The command is held between samples and the velocity is solved exactly. Initial angle and
    velocity of every record are eliminated by linear least squares. If the errors are not white,
    the spread between records, or between parts of few records, goes into the intervals.
    """

    def errors(x: Array) -> Array:
        motor = start.with_parameters(x)
        return np.concatenate([motor.errors(record) for record in records])

    def slopes(x: Array) -> Array:
        motor = start.with_parameters(x)
        return np.concatenate([motor.derivatives(record) for record in records])

    scale = np.ones(len(start.parameters))
    scale[-1] = min(record.step for record in records)
    x, settled = search(errors, slopes, start.parameters, scale)
    if not settled:
        raise DataError(
            "the fit in the time domain does not settle",
            remedy="check the records, or give a ready frequency response",
        )
    motor, left = start.with_parameters(x), errors(x)
    known = _uncertainty(records, slopes(x), left)
    gain, time_constant, *friction = known.estimates(x)[:-1]
    return ActuatorFit(
        method="output in the time domain",
        gain=gain,
        time_constant=time_constant,
        friction=friction[0] if friction else None,
        uncertainty=known,
        dead_time=_dead_time(motor.delay, known, longest_delay(records)),
        motor=motor,
        errors=left,
    )


def _dead_time(delay: float, known: Uncertainty, longest: float) -> Estimate | None:
    """Return a dead time, never below zero; None for one that may be beyond the longest."""
    half = student_quantile(known.degrees) * float(known.errors[-1])
    ends = (delay, delay - half, delay + half)
    return Estimate(*(max(end, 0.0) for end in ends)) if ends[-1] <= longest else None


def _uncertainty(records: Sequence[SignalRecord], J: Array, errors: Array) -> Uncertainty:
    ends = np.cumsum([0, *(len(record.time) for record in records)]).tolist()
    starts = ends[:-1] if len(records) >= MANY_RECORDS else None
    parts = zip(records, np.split(J, ends[1:-1]), strict=True)
    scatter = np.sum([rounding_scatter(r.output, slope, 1.0) for r, slope in parts], axis=0)
    return uncertainty(J, errors, starts, scatter)


def fit_response(data: FrequencyResponse) -> ActuatorFit:
    """Fit gain and time constant to a ready frequency response of three frequencies or more.

    Minimizes the logarithm of data over model, whose real part is the magnitude ratio and whose
    imaginary part is the phase difference. Friction cannot be told from a ratio.
    """
    count = len(np.unique(np.round(np.log(data.frequency), 3)))
    if count < _FEWEST_FREQUENCIES:
        raise DataError(
            f"the data have {count} different frequencies, at least {_FEWEST_FREQUENCIES} are "
            "needed",
            remedy="record sinusoids below and above the break frequency",
        )

    def errors(x: Array) -> Array:
        gain, tau = np.exp(x)
        return _stacked(np.log(data.response * (1 + 1j * data.frequency * tau) / gain))

    def slopes(x: Array) -> Array:
        pole = 1j * data.frequency * np.exp(x[1])
        return _stacked(np.column_stack([np.ones(len(pole), complex), -pole / (1 + pole)]))

    start = np.array([np.log(np.abs(data.response).max()), -np.log(np.median(data.frequency))])
    x, settled = search(errors, slopes, start, np.ones(2))
    if not settled:
        raise DataError(
            "no first-order velocity model fits this response",
            path=data.source.path,
            remedy="check the units of magnitude and phase; the response is velocity over command",
        )
    known = uncertainty(slopes(x), errors(x))
    gain, time_constant = known.estimates(x)
    return ActuatorFit("ready frequency response", gain, time_constant, None, known)


def _stacked(values: Complex) -> Array:
    """Write complex equations as real ones, real and imaginary parts in turn."""
    parts = np.stack([values.real, values.imag], axis=1)
    return np.asarray(parts.reshape(-1, *values.shape[1:]), float)
