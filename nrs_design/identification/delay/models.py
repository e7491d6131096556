"""What may lie between a command and its measurement, beside a delay."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import exp

import numpy as np

from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.held import Held, Lags
from nrs_design.identification.numeric import Array


@dataclass(frozen=True)
class AbstractFollower(ABC):
    """A model of what follows a command; gain, offset and initial state are linear."""

    shape: tuple[float, ...] = ()  # Logarithms of its other parameters
    name: str = "a copy"

    @abstractmethod
    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return what the output is a combination of, shape (n, p), at a delay in s."""


class SmoothCopy(AbstractFollower):
    """The command itself, later; between samples it is smooth."""

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return the command and a constant."""
        from scipy.interpolate import CubicSpline

        at = np.clip(record.time - delay, record.time[0], record.time[-1])
        return np.column_stack([CubicSpline(record.time, record.sent)(at), np.ones_like(at)])


class HeldCopy(AbstractFollower):
    """The command itself, whole samples later; between samples nothing is known of it."""

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return the command and a constant."""
        rows = np.arange(len(record.time)) - round(delay / record.step)
        at = np.clip(rows, 0, len(record.time) - 1)
        return np.column_stack([record.sent[at], np.ones(len(at))])


@dataclass(frozen=True)
class Lagged(AbstractFollower):
    """Lags of the command that is held between samples, or their integral."""

    lags: Callable[..., Lags] = Lags.first_order  # By the parameters
    angle: bool = False  # Whether it is the integral, as of a motor that is commanded a velocity

    def columns(self, record: SignalRecord, delay: float) -> Array:
        """Return output, constant and initial state; of an integral a drift of the command, too."""
        lags, held = self.lags(*map(exp, self.shape)), _held(record, delay)
        output = (lags.angle if self.angle else lags.velocity)(held, held.command)[held.samples]
        constant = record.time if self.angle else np.ones_like(output)
        return np.column_stack([output, constant, _free(record, lags, angle=self.angle)])


def first_order(*shape: float) -> Lagged:
    """Return a first-order lag; its shape is the logarithm of the time constant in s."""
    return Lagged(shape, "a first-order lag")


def second_order(*shape: float) -> Lagged:
    """Return a second-order lag, as of a position loop, with logarithms of 1/omega and zeta."""
    return Lagged(shape, "a second-order lag", _second_order)


def _second_order(tau: float, damping: float) -> Lags:
    return Lags.second_order(1 / tau, damping)


def integrator(*shape: float) -> Lagged:
    """Return the integral of a first-order lag."""
    return Lagged(shape, "a lag and an integrator", angle=True)


@lru_cache(maxsize=32)
def _held(record: SignalRecord, delay: float) -> Held:
    """Return what acts so late; several shapes are tried at each delay."""
    return Held.of(record.time, record.sent, delay)


def _free(record: SignalRecord, lags: Lags, *, angle: bool) -> Array:
    """Return what initial states add, those of every stretch between pauses, shape (n, p)."""
    parts = []
    for rows in record.stretches:
        free = lags.free(record.time[rows], angle=angle)
        part = np.zeros((len(record.time), free.shape[1]))
        part[rows] = free
        parts.append(part)
    return np.column_stack(parts)
