"""The model fitted to the angles themselves, by output error."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from nrs_design.errors import DataError
from nrs_design.identification.actuator.friction import friction_shape
from nrs_design.identification.actuator.model import ActuatorFit, actuator_fit
from nrs_design.identification.datasets import SinusoidRecord
from nrs_design.identification.rounding import rounding_scatter
from nrs_design.identification.statistics import uncertainty
from nrs_design.models.recursion import run_first_order

Array = NDArray[np.float64]

_STEPS = 40
_CONVERGED = 1e-6
_DIFFERENCE = 1e-5
_LARGEST_STEP = 0.5


def fit_angles(records: Sequence[SinusoidRecord], start: ActuatorFit) -> ActuatorFit:
    """Refine a fit in the time domain.

    The command is held between samples and the velocity is solved exactly. The direction of the
    friction is that of the model's own velocity. Initial angle and velocity of every record are
    eliminated by linear least squares. If the errors are not white, the spread between records
    goes into the intervals.

    Parameters
    ----------
    records : sequence of SinusoidRecord
        At least four, one more than there are parameters.
    start : ActuatorFit
        From `fit_phasors`.

    Raises
    ------
    DataError
        If the iteration does not settle.
    """
    if start.friction is None:
        raise ValueError("the start has no friction")
    logs = np.log([start.gain.value, start.time_constant.value, start.friction.value])
    for _ in range(_STEPS):
        parts = [_linearize(record, logs) for record in records]
        J, error = (np.concatenate(series) for series in zip(*parts, strict=True))
        step = np.linalg.lstsq(J, error, rcond=None)[0]
        logs = logs + np.clip(step, -_LARGEST_STEP, _LARGEST_STEP)
        if np.abs(step).max() < _CONVERGED:
            break
    else:
        raise DataError(
            "the fit in the time domain does not settle",
            remedy="check the records, or give a ready frequency response",
        )
    starts = np.cumsum([0, *(len(record.time) for record in records[:-1])]).tolist()
    scatter = sum(
        (rounding_scatter(r.angle, part, 1.0) for r, (part, _) in zip(records, parts, strict=True)),
        start=np.zeros((3, 3)),
    )
    known = uncertainty(J, error, starts, scatter)
    return actuator_fit("angles in the time domain", logs, known)


def simulate_angle(record: SinusoidRecord, gain: float, tau: float, friction: float) -> Array:
    """Return the angle of the model in rad, shape (n,).

    Initial angle and velocity are fitted to the record.

    Parameters
    ----------
    record : SinusoidRecord
        With command and measured angle.
    gain : float
        In (rad/s)/rpm.
    tau : float
        Time constant in s.
    friction : float
        In rpm of command.
    """
    forced = _angle(record, gain, tau, friction, friction_shape(record, gain, tau, friction))
    free = _free(record, tau)
    start = np.linalg.lstsq(free, record.angle - forced, rcond=None)[0]
    return np.asarray(forced + free @ start, float)


def _linearize(record: SinusoidRecord, logs: Array) -> tuple[Array, Array]:
    """Return derivatives and errors of a record without what its initial state explains."""
    shape = friction_shape(record, *np.exp(logs).tolist())

    def forced(x: Array) -> Array:
        gain, tau, friction = np.exp(x).tolist()
        return _angle(record, gain, tau, friction, shape)

    steps = _DIFFERENCE * np.eye(3)
    J = np.column_stack([(forced(logs + h) - forced(logs - h)) / (2 * _DIFFERENCE) for h in steps])
    free, _ = np.linalg.qr(_free(record, float(np.exp(logs[1]))))
    both = np.column_stack([J, record.angle - forced(logs)])
    both -= free @ (free.T @ both)
    return both[:, :3], both[:, 3]


def _angle(record: SinusoidRecord, gain: float, tau: float, friction: float, shape: Array) -> Array:
    """Return the angle from rest at zero, exact for a command held between samples."""
    dt = np.diff(record.time)
    a = np.exp(-dt / tau)
    drive = gain * (record.command - friction * shape)[:-1]
    velocity = run_first_order(a, (1 - a) * drive)
    travel = drive * dt + tau * (1 - a) * (velocity[:-1] - drive)
    return np.concatenate([[0.0], np.cumsum(travel)])


def _free(record: SinusoidRecord, tau: float) -> Array:
    """Return the angles that follow from initial angle and velocity, shape (n, 2)."""
    return np.column_stack([np.ones_like(record.time), tau * -np.expm1(-record.time / tau)])
