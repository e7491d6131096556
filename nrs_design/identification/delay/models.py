"""What may lie between a command and its measurement, beside a delay."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.held import Held, Lags
from nrs_design.identification.numeric import Array


@dataclass(frozen=True, slots=True)
class AbstractFollower(ABC):
    """A model of what follows a command; gain, offset and initial state are linear."""

    shape: tuple[float, ...]  # Logarithms of its other parameters

    name: ClassVar[str]

    @abstractmethod
    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return what the output is a combination of, shape (n, p), at a delay in s."""


class SmoothCopy(AbstractFollower):
    """The command itself, later; between samples it is smooth."""

    name: ClassVar[str] = "a copy"

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return the command and a constant."""
        from scipy.interpolate import CubicSpline

        at = np.clip(record.time - delay, record.time[0], record.time[-1])
        return np.column_stack([CubicSpline(record.time, record.sent)(at), np.ones_like(at)])


class HeldCopy(AbstractFollower):
    """The command itself, whole samples later; between samples nothing is known of it."""

    name: ClassVar[str] = "a copy"

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return the command and a constant."""
        rows = np.arange(len(record.time)) - round(delay / record.step)
        at = np.clip(rows, 0, len(record.time) - 1)
        return np.column_stack([record.sent[at], np.ones(len(at))])


class FirstOrder(AbstractFollower):
    """A first-order lag of the command that is held between samples."""

    name: ClassVar[str] = "a first-order lag"

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return output, constant and the initial state."""
        return _following(record, Lags.first_order(float(np.exp(self.shape[0]))), delay)


class SecondOrder(AbstractFollower):
    """A second-order lag, as of a position loop."""

    name: ClassVar[str] = "a second-order lag"

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return output, constant and the initial state."""
        tau, damping = np.exp(self.shape).tolist()
        return _following(record, Lags.second_order(1 / tau, damping), delay)


class Integrator(AbstractFollower):
    """The integral of a first-order lag, as of a motor that is commanded a velocity."""

    name: ClassVar[str] = "a lag and an integrator"

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return output, constant and the initial state; a drift of the command, too."""
        lags = Lags.first_order(float(np.exp(self.shape[0])))
        held = _held(record, delay)
        angle = lags.angle(held, held.command)[held.samples]
        return np.column_stack([angle, _free(record, lags, angle=True), record.time])


@lru_cache(maxsize=32)
def _held(record: SignalRecord, delay: float) -> Held:
    """Return what acts so late; several shapes are tried at each delay."""
    return Held.of(record.time, record.sent, delay)


def _following(record: SignalRecord, lags: Lags, delay: float) -> Array:
    held = _held(record, delay)
    output = lags.velocity(held, held.command)[held.samples]
    return np.column_stack([output, np.ones_like(output), _free(record, lags, angle=False)])


def _free(record: SignalRecord, lags: Lags, *, angle: bool) -> Array:
    """Return what initial states add, those of every stretch between pauses, shape (n, p)."""
    parts = []
    for rows in record.stretches:
        free = lags.free(record.time[rows], angle=angle)
        part = np.zeros((len(record.time), free.shape[1]))
        part[rows] = free
        parts.append(part)
    return np.column_stack(parts)
