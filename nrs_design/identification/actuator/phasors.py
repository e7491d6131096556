"""Sinusoids as complex amplitudes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from nrs_design.identification.datasets.records import ActuatorRecord
from nrs_design.identification.numeric import Array

# The response is taken as periodic after this part of a record.
_TRANSIENT = 0.25
_FEWEST_PERIODS = 2.0
_HARMONICS = (1, 3, 5)
# Part of the command's power that its sinusoid must account for.
_PURE = 0.98


@dataclass(frozen=True, slots=True)
class Phasors:
    """One record at its frequency."""

    record: ActuatorRecord  # The data
    frequency: float  # In rad/s
    command: complex  # Amplitude in rpm, as it acts on the motor
    velocity: complex  # Amplitude in rad/s


def phasors_of(record: ActuatorRecord) -> Phasors | None:
    """Find frequency and amplitudes of a sinusoid of two periods or more by least squares.

    None for any other command.

    The angle may drift, has harmonics from friction, and begins with a transient that is left
    out. Its amplitude times ``j omega`` is that of the velocity: nothing is differentiated.
    """
    frequency = _frequency(record)
    late = record.time >= _TRANSIENT * record.time[-1]
    periods = float(np.ptp(record.time[late])) * frequency / (2 * np.pi)
    if periods < _FEWEST_PERIODS:
        return None
    (command,), share = _amplitudes(record.time, record.command, frequency, (1,))
    if share < _PURE:
        return None
    (output, *_), _ = _amplitudes(record.time[late], record.output[late], frequency, _HARMONICS)
    velocity = 1j * frequency * output if record.is_angle else output
    return Phasors(record, frequency, command * _hold(record, frequency), velocity)


def held_amplitude(record: ActuatorRecord, values: Array, frequency: float) -> complex:
    """Return the amplitude of what is held between samples, as it acts, at a frequency in rad/s."""
    late = record.time >= _TRANSIENT * record.time[-1]
    (amplitude, *_), _ = _amplitudes(record.time[late], values[late], frequency, _HARMONICS)
    return amplitude * _hold(record, frequency)


def _hold(record: ActuatorRecord, frequency: float) -> complex:
    """Return the effect of holding a value between samples: it acts half a step later."""
    half = frequency * record.step / 2
    return complex(np.sinc(half / np.pi) * np.exp(-1j * half))


def _frequency(record: ActuatorRecord) -> float:
    """Return the frequency in rad/s at which a sinusoid fits the command best."""
    from scipy.optimize import minimize_scalar

    time, command = record.time, record.command
    count = len(time)
    even = np.interp(np.linspace(0, time[-1], count), time, command - command.mean())
    spectrum = np.abs(np.fft.rfft(even * np.hanning(count)))
    width = 2 * np.pi / float(time[-1])
    guess = width * max(int(np.argmax(spectrum[1:])) + 1, 1)

    def missed(frequency: float) -> float:
        return 1 - _amplitudes(time, command, frequency, (1,))[1]

    grid = np.linspace(max(guess - width, 0.3 * width), guess + width, 17)
    near = grid[int(np.argmin([missed(w) for w in grid]))]
    bounds = (near - width / 8, near + width / 8)
    found = minimize_scalar(missed, bounds=bounds, method="bounded", options={"xatol": 1e-9 * near})
    return float(found.x)


def _amplitudes(
    time: Array, values: Array, frequency: float, harmonics: Sequence[int]
) -> tuple[list[complex], float]:
    """Fit drift and harmonics; return amplitudes and the part of the power that they explain."""
    waves = [np.exp(1j * k * frequency * time) for k in harmonics]
    columns = [part for wave in waves for part in (wave.real, wave.imag)]
    middle = (time - time.mean()) / np.ptp(time)
    X = np.column_stack([*columns, np.ones_like(time), middle])
    solution = np.linalg.lstsq(X, values, rcond=None)[0]
    rest = values - X @ solution
    share = 1 - float(rest @ rest) / float(np.sum((values - values.mean()) ** 2))
    pairs = solution[: len(columns)].reshape(-1, 2)
    return [complex(a, -b) for a, b in pairs], share
