"""The model fitted to complex responses."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.actuator.friction import friction_shape
from nrs_design.identification.actuator.model import ActuatorFit, actuator_fit
from nrs_design.identification.actuator.phasors import Phasors, held_amplitude
from nrs_design.identification.datasets.records import FrequencyResponse
from nrs_design.identification.held import Held
from nrs_design.identification.numeric import Array, Complex
from nrs_design.identification.statistics import Uncertainty, uncertainty

FEWEST = 3
_MANY_STEPS = 60
_FRICTION_STEPS = 5
_CONVERGED = 1e-12


def fit_phasors(phasors: Sequence[Phasors]) -> ActuatorFit | None:
    """Fit gain, time constant and friction to sinusoid records of three frequencies or more.

    None for fewer, or where the responses are not those of such a motor.

    ``U = V (1 + j w tau)/gain + friction S``, linear in ``1/gain``, ``tau/gain`` and the friction:
    a complex least-squares problem. S is the first harmonic of the friction over its largest
    value: ``4/pi V/|V|`` for a square wave, and then that of the fitted motor, which also sticks.
    Equations are weighted for angles with white noise.
    """
    if _frequencies(np.array([p.frequency for p in phasors])) < FEWEST:
        return None
    V = np.array([p.velocity for p in phasors])
    S, tau = 4 / pi * V / np.abs(V), 0.0
    for _ in range(_FRICTION_STEPS):
        solution, X, error = _solve(phasors, V, S, tau)
        if not (solution > 0).all():
            return None
        gain, tau, friction = 1 / solution[0], solution[1] / solution[0], solution[2]
        S = np.array([_friction_phasor(p, gain, tau, friction) for p in phasors])
    known = uncertainty(X * solution, error)
    # From the logarithms of 1/gain and tau/gain to those of gain and tau.
    turn = np.array([[-1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    turned = Uncertainty(turn @ known.covariance @ turn.T, known.degrees, known.whiteness)
    return actuator_fit("complex response of the records", turn @ np.log(solution), turned)


def _solve(
    phasors: Sequence[Phasors], V: Complex, S: Complex, tau: float
) -> tuple[Array, Array, Array]:
    """Solve the weighted equations; return solution, weighted matrix and errors."""
    U = np.array([p.command for p in phasors])
    w = np.array([p.frequency for p in phasors])
    counts = np.array([len(p.record.time) for p in phasors])
    weights = np.sqrt(counts / counts.mean()) / (w * np.abs(1 + 1j * w * tau))
    rows = np.column_stack([V, 1j * w * V, S]) * weights[:, None]
    X, y = _stacked(rows), _stacked(U * weights)
    solution = np.linalg.lstsq(X, y, rcond=None)[0]
    return np.asarray(solution, float), X, np.asarray(y - X @ solution, float)


def _friction_phasor(phasors: Phasors, gain: float, tau: float, friction: float) -> complex:
    record = phasors.record
    held = Held.of(record.time, record.command, 0.0)
    shape = friction_shape(held, gain, tau, friction)
    return held_amplitude(record, np.append(shape, shape[-1]), phasors.frequency)


def fit_response(data: FrequencyResponse) -> ActuatorFit:
    """Fit gain and time constant to a ready frequency response of three frequencies or more.

    Minimizes the logarithm of data over model, whose real part is the magnitude ratio and whose
    imaginary part is the phase difference. Friction cannot be told from a ratio.
    """
    count = _frequencies(data.frequency)
    if count < FEWEST:
        raise DataError(
            f"the data have {count} different frequencies, at least {FEWEST} are needed",
            remedy="record sinusoids below and above the break frequency",
        )
    logs = np.array([np.log(np.abs(data.response).max()), -np.log(np.median(data.frequency))])
    for _ in range(_MANY_STEPS):
        gain, tau = np.exp(logs)
        pole = 1 + 1j * data.frequency * tau
        error = np.log(data.response * pole / gain)
        J = np.column_stack([np.ones(len(pole), complex), -1j * data.frequency * tau / pole])
        step = np.linalg.lstsq(_stacked(J), _stacked(error), rcond=None)[0]
        logs = logs + np.clip(step, -1.0, 1.0)
        if np.abs(step).max() < _CONVERGED:
            break
    else:
        raise DataError(
            "no first-order velocity model fits this response",
            path=data.source.path,
            remedy="check the units of magnitude and phase; the response is velocity over command",
        )
    known = uncertainty(_stacked(J), _stacked(error))
    return actuator_fit("ready frequency response", logs, known)


def _frequencies(frequency: Array) -> int:
    """Return how many different ones there are."""
    return len(np.unique(np.round(np.log(frequency), 3)))


def _stacked(values: Complex) -> Array:
    """Write complex equations as real ones, real and imaginary parts in turn."""
    parts = np.stack([values.real, values.imag], axis=1)
    return np.asarray(parts.reshape(-1, *values.shape[1:]), float)
