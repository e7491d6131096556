"""Margins of many open loops at once, for a search that must respect them.

Each margin is taken at the exact stationary or crossover frequencies of its loop. By hand, as
python-control takes one loop after the other, on a grid; the tests hold it against these.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from nrs_design.design.transfer import (
    BoolArray,
    ComplexArray,
    FloatArray,
    frequencies,
    hurwitz,
    multiply,
    product_parts,
    ratio,
    squared,
    stationary,
)
from nrs_design.loop.cut_loop import CutLoop
from nrs_design.models.contact import AbstractLinearLaw


@dataclass(frozen=True, eq=False)
class Loops:
    """Many open loops ``N/D``.

    Every margin of a loop that is not stable when it is closed is the worst possible: infinite
    where it should be small, 0 where it should be large. A margin that nothing limits is infinite.
    """

    # numerator, denominator: shape (n, m + 1). One polynomial in s per row, highest power first,
    # padded to one length.
    numerator: FloatArray
    denominator: FloatArray
    # Sampled: the time between two samples in s, and the polynomials are in ``(2/T) (z - 1)/(z +
    # 1)`` instead of s.
    period: float | None = None

    @classmethod
    def from_cut(cls, cut_loop: CutLoop, period: Fraction | None) -> Loops:
        """Return the one loop of a mode that is cut; the period is in s."""
        exact = (
            [c - o for c, o in zip(cut_loop.closed, cut_loop.opened, strict=True)],
            cut_loop.opened,
        )
        numerator, denominator = (np.array([p], dtype=np.float64) for p in exact)
        return cls(numerator, denominator, None if period is None else float(period))

    @cached_property
    def closed(self) -> FloatArray:
        """The characteristic polynomials."""
        return self.numerator + self.denominator

    @cached_property
    def stable(self) -> BoolArray:
        """Which closed loops are Hurwitz."""
        return hurwitz(self.closed)

    def sensitivity_peak(self) -> FloatArray:
        """Return ``Ms = max |1/(1 + N/D)|``, at least 1, its limit at high frequency."""
        peak = np.maximum(1.0, _peak(self.denominator, self.closed))
        return np.where(self.stable, peak, np.inf)

    def peak_frequency(self) -> FloatArray:
        """Return the frequency of Ms, rad/s; infinite for a limit at high frequency."""
        omega = stationary(self.denominator, self.closed)
        magnitude = np.nan_to_num(np.abs(ratio(self.denominator, self.closed, omega)))
        padded = np.concatenate([magnitude, np.ones((len(omega), 1))], axis=1)
        places = np.concatenate([omega, np.full((len(omega), 1), np.inf)], axis=1)
        best = padded.argmax(axis=1)[:, None]
        return self._true(np.take_along_axis(places, best, axis=1)[:, 0])

    def disk_margin(self) -> FloatArray:
        """Return ``1/max |S - 1/2|``, at most 2."""
        peak = np.maximum(1.0, _peak(self.denominator - self.numerator, self.closed))
        return np.where(self.stable, 2 / peak, 0.0)

    def gain_margin(self) -> FloatArray:
        """Return the smallest factor above 1 on the loop gain that destabilizes."""
        _, imaginary = product_parts(self.numerator, self.denominator)
        omega = frequencies(imaginary)
        last = _limit(self.numerator, self.denominator)[:, None]
        response = np.concatenate([self._response(omega).real, last], axis=1)
        is_inside = (response < 0) & (response > -1)
        gain = -1 / np.where(is_inside, response, np.nan)
        return np.where(self.stable, _smallest(gain), 0.0)

    def phase_margin(self) -> FloatArray:
        """Return the smallest phase, of either sign, that destabilizes, in rad."""
        phase, _ = self._crossovers
        return np.where(self.stable, _smallest(np.abs(phase)), 0.0)

    def delay_margin(self) -> FloatArray:
        """Return the longest dead time up to which none destabilizes, in s.

        Sampled, dead times are whole samples by which the force is older.
        """
        phase, omega = self._crossovers
        dead = _smallest(phase % (2 * math.pi) / self._true(omega))
        if self.period is not None:
            dead = np.floor(dead / self.period) * self.period
            last = np.abs(_limit(self.numerator, self.denominator))
            dead = np.where(last < 1, dead, 0.0)
        return np.where(self.stable, dead, 0.0)

    def response(self, omega: FloatArray) -> ComplexArray:
        """Return every open loop at frequencies in rad/s, below half the sampling rate."""
        warped = omega if self.period is None else 2 / self.period * np.tan(omega * self.period / 2)
        return self._response(np.broadcast_to(warped, (len(self.numerator), len(omega))))

    def _true(self, omega: FloatArray) -> FloatArray:
        """Return the frequencies of points on the imaginary axis."""
        half = None if self.period is None else self.period / 2
        return omega if half is None else np.arctan(omega * half) / half

    @cached_property
    def _crossovers(self) -> tuple[FloatArray, FloatArray]:
        """Return the phase over -180 degrees, and the frequency, of every gain crossover."""
        excess = squared(self.numerator) - squared(self.denominator)
        omega = frequencies(excess)
        return np.angle(-self._response(omega)), omega

    def _response(self, omega: FloatArray) -> ComplexArray:
        return ratio(self.numerator, self.denominator, omega)


def _limit(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    """Return the ratios at infinite frequency, or at half the sampling rate."""
    first = (denominator != 0).argmax(axis=1)[:, None]
    dividend, divisor = (
        np.take_along_axis(p, first, axis=1)[:, 0] for p in (numerator, denominator)
    )
    return dividend / divisor


def gain_extremes(
    numerator: FloatArray, denominator: FloatArray, bandwidth: float
) -> tuple[FloatArray, FloatArray]:
    """Return the smallest and largest ``|numerator/denominator|`` on 0 to `bandwidth` in rad/s.

    Polynomials in s, highest power first, one per row; no denominator vanishes on the axis.
    """
    omega = stationary(numerator, denominator)
    omega = np.where(omega < bandwidth, omega, np.nan)
    ends = np.broadcast_to([0.0, bandwidth], (len(omega), 2))
    omega = np.concatenate([omega, ends], axis=1)
    magnitude = np.abs(ratio(numerator, denominator, omega))
    return np.fmin.reduce(magnitude, axis=1), np.fmax.reduce(magnitude, axis=1)


def _peak(numerator: FloatArray, denominator: FloatArray) -> FloatArray:
    omega = stationary(numerator, denominator)
    magnitude = np.abs(ratio(numerator, denominator, omega))
    last = np.abs(_limit(numerator, denominator))
    return np.fmax(last, np.fmax.reduce(magnitude, axis=1, initial=0.0))


def _smallest(values: FloatArray) -> FloatArray:
    return np.asarray(np.fmin.reduce(values, axis=1, initial=np.inf))


def transparency(loops: Loops, bandwidth: float) -> FloatArray:
    """Return the smallest ``|L/(1 + L)|`` from 0 to a frequency in rad/s; 0 if unstable.

    A hand that holds the robot (thesis 7.2) is the environment: with its impedance Ze it pulls the
    robot along. Of the velocity that it means to have, the robot makes ``L/(1 + L)``.
    """
    low, _ = gain_extremes(*_cancelled(loops.numerator, loops.closed), bandwidth)
    return np.where(loops.stable, low, 0.0)


def hand_effort(loops: Loops, hand: AbstractLinearLaw, bandwidth: float) -> FloatArray:
    """Return the largest ``|Ze/(1 + L)|`` from 0 to a frequency in rad/s, in N m s/rad.

    That is the force of the hand over the velocity that it means to have. Infinite where the loop
    is unstable, or where the hand has to hold against a spring.
    """
    above, below = (np.tile(part, (len(loops.numerator), 1)) for part in hand.impedance)
    numerator, denominator = _cancelled(
        multiply(above, loops.denominator), multiply(below, loops.closed)
    )
    if not np.all(denominator[:, -1]):
        return np.full(len(numerator), np.inf)
    _, high = gain_extremes(numerator, denominator, bandwidth)
    return np.where(loops.stable, high, np.inf)


def _cancelled(numerator: FloatArray, denominator: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Leave out powers of s that are in both polynomials of every row."""
    while not (numerator[:, -1].any() or denominator[:, -1].any()):
        numerator, denominator = numerator[:, :-1], denominator[:, :-1]
    return numerator, denominator
