"""The delay between two columns of a record."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import pairwise

import numpy as np

from nrs_design.identification.datasets.records import (
    FEWEST_ROWS,
    AbstractIdentification,
    SignalRecord,
    doubt_step,
    question_sizes,
)
from nrs_design.identification.delay.fit import (
    EXACT,
    AbstractFollower,
    DelayFit,
    HeldCopy,
    Lagged,
    SmoothCopy,
    fit_delay,
    fit_errors,
    fit_held,
)
from nrs_design.identification.errors import DataError
from nrs_design.identification.numeric import Array, Rows
from nrs_design.identification.statistics import (
    WHITE,
    Estimate,
    independent,
    joint_level,
    student_quantile,
)
from nrs_design.identification.zero_order_hold import Lags

# Longest delay in the search, as a part of the record.
_LONGEST = 0.1
# Accuracy of a search for a delay and a lag, in samples.
_OFF = 2e-3
# Largest distance from an integer that counts as rounding, in periods.
_NEARLY_WHOLE = Fraction(1, 10**6)
_PARTS = 10
_PART_STEPS = 6
# A model with more parameters must lower BIC by this much (very strong evidence: Kass and Raftery
# 1995).
_CLEARLY = 10.0
# In samples: step of a difference quotient, and a variation that is worth a doubt.
_PART_SHIFT = 0.05
_NOTABLE = 0.1
# Below this correlation the columns are unrelated.
_RELATED = 0.2
# Relative errors of a model with colored residuals. The first raises a doubt; above the second,
# intervals for white noise do not hold.
_MISSED = 0.02
_UNEXPLAINED = 0.1
# Least fraction of the power outside one frequency: below, delay and lag are indistinguishable.
_MULTITONE_POWER = 0.01
# Largest error of a spline through every other sample of a smooth command, relative to the change
# from sample to sample.
_SMOOTH = 0.05
# Half width in samples of the search for the delay of a part of the record.
_PART_RANGE = 50
# Rows at the begin that the command before the record may reach.
_ROWS_AFTER = 5
# Grid of a first search: time constants and delays in samples, and the rows that it uses.
_TIMES = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
_SHIFTS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
_SCANNED = 5000


@dataclass(frozen=True, eq=False)
class DelayIdentification(AbstractIdentification[SignalRecord]):
    """What a record says about a delay."""

    fits: tuple[DelayFit, ...]  # One for each model, a copy of the command first
    fit: DelayFit  # The simplest fit whose BIC none clearly beats
    # Lag in s at which both columns are most alike, lag of the dynamics included, and their
    # correlation there.
    peak: tuple[float, float]

    @property
    def record(self) -> SignalRecord:
        """The data."""
        return self.records[0]

    @property
    def smooth(self) -> bool:
        """Whether the command is smooth between samples: fractions of a sample are identifiable.

        Otherwise, or beside a lag, nobody knows when within a sample a logged command began: the
        interval is a sample wide, at least.
        """
        return isinstance(self.fits[0].follower, SmoothCopy)

    @cached_property
    def interval(self) -> Estimate:
        """The delay in samples with its 95 % interval, which may be below zero."""
        fit = self.fit
        if isinstance(fit.follower, HeldCopy):
            return _held_interval(fit, fit.rows, joint_level(1))
        half = student_quantile(fit.uncertainty.degrees) * float(fit.uncertainty.errors[0])
        if hidden := _hidden(fit):
            # A search ends a little off, also where no noise shows it.
            half = max(half, _OFF)
        return Estimate(fit.samples, fit.samples - half, fit.samples + half + hidden)

    @property
    def samples(self) -> Estimate:
        """The delay in samples of the record, not negative, with its 95 % interval.

        Where a sample is the least width of an interval, so is the rest above zero.
        """
        low = max(self.interval.low, 0.0)
        high = max(self.interval.high, low + _hidden(self.fit), 0.0)
        return Estimate(max(self.fit.samples, 0.0), low, high)

    @property
    def delay(self) -> Estimate:
        """In s, with a 95 % interval."""
        return self.samples.scaled(self.record.step)

    @cached_property
    def parts(self) -> tuple[tuple[float, Estimate], ...]:
        """The delay in samples in parts of the record, by their middle in s.

        The intervals hold at 95 % for all parts together.
        """
        return tuple(_parts(self.fit))

    @cached_property
    def one_frequency(self) -> bool:
        """Whether the command is a sinusoid of one frequency."""
        return _part_of_other_frequencies(self.record) < _MULTITONE_POWER

    @cached_property
    def delay_range(self) -> tuple[Fraction, Fraction]:
        """Delays in s for a spec: they hold the interval and every part of the record.

        Where errors are not noise, they hold those of a copy, too: then a lag may stand for a part
        of the delay. For a command of one frequency, they hold all from zero to those of a copy.
        """
        estimates = [self.samples, *(part for _, part in self.parts)]
        if self.one_frequency:
            estimates.append(Estimate(0.0, 0.0, 0.0))
        if self.one_frequency or self.fit.uncertainty.whiteness < WHITE:
            estimates += [part for _, part in _parts(self.fits[0])]
        ends = min(e.low for e in estimates), max(e.high for e in estimates)
        low, high = (Fraction(max(end, 0.0)) * Fraction(self.record.step) for end in ends)
        return low, high

    def periods(self, period: Fraction) -> tuple[int, int]:
        """Return `delay_range` in periods, rounded outward to integers; the period is in s."""
        low, high = (end / period for end in self.delay_range)
        return math.floor(low + _NEARLY_WHOLE), math.ceil(high - _NEARLY_WHOLE)

    @property
    def whole_samples(self) -> tuple[int, int]:
        """`delay_range` in whole samples of the record."""
        return self.periods(Fraction(self.record.step))

    @property
    def is_lag(self) -> bool:
        """Whether dynamics lie between the columns: they leave nothing but noise."""
        lagged = isinstance(self.fit.follower, Lagged)
        return lagged and self.fit.uncertainty.whiteness >= WHITE

    @property
    def untold(self) -> str | None:
        """Why the record does not tell the delay: an interval that is longer than the record."""
        length = float(np.ptp(self.record.time))
        if self.delay.high - self.delay.low <= length:
            return None
        return f"not determined by this record: the interval exceeds its length of {length:.3g} s"

    @property
    def remarks(self) -> tuple[str, ...]:
        """Pauses, and the time resolution of the record, as sentences."""
        command = self.record.names[0]
        rests = (
            f"the record does not tell when within a sample {command} changed: no interval is "
            "below a sample"
        )
        if not _hidden(self.fit):
            rests = f"{command} is smooth between samples: parts of a sample are told"
        return (self.record.pauses, rests) if self.record.pauses else (rests,)

    @cached_property
    def doubts(self) -> tuple[str, ...]:
        """What speaks against the delay."""
        return (*_rivals(self), *_doubts(self))

    @property
    def caveats(self) -> tuple[str, ...]:
        """Doubts, pauses, and dynamics between the columns, as sentences."""
        texts = (*self.doubts, self.record.pauses) if self.record.pauses else self.doubts
        if not isinstance(self.fit.follower, Lagged):
            return texts
        command, output = self.record.names
        name = self.fit.follower.name
        return (*texts, f"{name} fits better between {command} and {output} than a mere delay")


def identify_delay(record: SignalRecord) -> DelayIdentification:
    """Find the delay by cross-correlation, then by a fit of delay and dynamics.

    Columns without relation, or a delay that explains little, are a `DataError`.
    """
    peak = correlation_peak(record)
    if abs(peak[1]) < _RELATED:
        raise DataError(
            f"{record.names[1]} does not follow {record.names[0]}: their largest correlation is "
            f"{peak[1]:.2f}",
            path=record.source.path,
            remedy="name other columns with --command and --measured, or record a livelier motion",
        )
    rows = _fitted_rows(record, peak[0])
    if is_smooth(record):
        copy = fit_delay(record, SmoothCopy(), peak[0], rows)
    else:
        copy = fit_held(record, peak[0], rows)
    lagged = (fit_delay(record, *start, rows) for start in _starts(record, peak[0], rows))
    # A search may leave the delays of its range.
    fits = (copy, *(fit for fit in lagged if abs(fit.delay) <= _longest(record)))
    # The simplest good model avoids a spurious fast lag, which resembles a delay and makes its
    # interval too narrow.
    lowest = min(fit.bic for fit in fits)
    good = [fit for fit in fits if fit.bic <= lowest + _CLEARLY]
    best = min(good, key=lambda fit: (len(fit.follower.shape), fit.bic))
    result = DelayIdentification((record,), fits, best, peak)
    _check_explained(result)
    return result


def _check_explained(result: DelayIdentification) -> None:
    """Refuse a model that misses much of the motion: its delay may be any.

    For a held command, the part of a sample is open: to be a sample late misses as much as the
    motion changes in a sample.
    """
    record, fit, limit = result.record, result.fit, _UNEXPLAINED
    if not result.smooth:
        motion = fit.measured - fit.measured.mean()
        change = np.linalg.norm(np.diff(fit.measured)) / np.linalg.norm(motion)
        limit = max(limit, float(change))
    if fit.missed_part <= limit or fit.uncertainty.whiteness >= WHITE:
        return
    raise DataError(
        f"no delay, with or without a lag, explains {record.names[1]} by {record.names[0]}: the "
        f"best misses {100 * fit.missed_part:.2g} % of the motion, in errors that are not noise",
        path=record.source.path,
        remedy=f"delays up to {_longest(record):.3g} s are tried, a tenth of the record: record "
        "ten times the longest delay, or a stretch with a constant delay",
    )


def _longest(record: SignalRecord) -> float:
    """Return the longest delay in the search, in s."""
    return _LONGEST * float(record.time[-1])


def is_smooth(record: SignalRecord) -> bool:
    """Tell whether a command is smooth between samples, so that a spline knows it there.

    Every other sample must tell those between them: it does of a measured motion, and does not of a
    command that is held or steps, nor of noise.
    """
    from scipy.interpolate import CubicSpline

    time, command = record.time, record.command
    # At both ends, a spline is free.
    errors = (CubicSpline(time[::2], command[::2])(time[1::2]) - command[1::2])[2:-2]
    steps = np.diff(command)
    return 2 * float(errors @ errors) <= _SMOOTH**2 * float(steps @ steps)


def _fitted_rows(record: SignalRecord, lag: float) -> Rows:
    """Return the rows that no command from before the record can reach."""
    rows = np.flatnonzero(record.time >= max(lag, 0.0) + _ROWS_AFTER * record.step)
    if len(rows) < FEWEST_ROWS:
        raise DataError(
            f"{len(rows)} rows are later than the largest correlation after its beginning, at "
            f"least {FEWEST_ROWS} are needed",
            path=record.source.path,
            remedy="record longer without a pause",
        )
    return rows


def _hidden(fit: DelayFit) -> float:
    """Return the largest delay that a log of commands hides, in samples.

    A command is logged up to a sample after it began. Only a copy of one that is smooth in between
    does not ask when that was.
    """
    return 0.0 if isinstance(fit.follower, SmoothCopy) else 1.0


def _held_interval(fit: DelayFit, rows: Rows, confidence: float) -> Estimate:
    """Return the best delay in integer samples, with the interval of all delays that fit the rows.

    That a copy is k samples late says of its delay that it is between k - 1 and k + 1: the command
    began up to a sample before it was logged, and its copy, too.
    """
    from scipy.special import chdtri

    lags = round(fit.samples) + np.arange(-_PART_RANGE, _PART_RANGE + 1)
    measured: Array = fit.record.output[rows]
    errors = [measured - fit.output(float(k))[rows] for k in lags]
    powers = np.array([float(error @ error) for error in errors])
    best = int(np.argmin(powers))
    # Neighbours that are alike count less; and without noise, rounding decides nothing.
    count = max(independent(errors[best]), 1.0)
    lowest = max(float(powers[best]), EXACT * float(np.sum(measured**2)))
    likely = lags[powers <= lowest * np.exp(float(chdtri(1, 1 - confidence)) / count)]
    low, high = (float(min(likely, default=lags[best])), float(max(likely, default=lags[best])))
    return Estimate(float(lags[best]), low - 1.0, high + 1.0)


def correlation_peak(record: SignalRecord) -> tuple[float, float]:
    """Return the lag in s at which both columns are most alike, and their correlation there.

    Columns are compared by their changes where those are alike more clearly, which is so for
    columns that drift.
    """
    time = record.time
    grid = np.linspace(time[0], time[-1], len(time))
    longest = max(int(_LONGEST * len(time)), 2)
    lags = np.arange(-longest, longest + 1)
    u, y = (np.interp(grid, time, values) for values in (record.command, record.output))
    peaks = []
    for a, b in ((u, y), (np.diff(u), np.diff(y))):
        alike = _correlations(a - np.mean(a), b - np.mean(b), lags)
        best = int(np.argmax(np.abs(alike)))
        peaks.append((float(lags[best]) * float(grid[1] - grid[0]), float(alike[best])))
    return max(peaks, key=lambda pair: abs(pair[1]))


def _correlations(u: Array, y: Array, lags: Rows) -> Array:
    """Return the correlation of ``u[i]`` with ``y[i + lag]`` where both are there."""
    size = 1 << (2 * len(u) - 1).bit_length()
    cross = np.fft.irfft(np.conj(np.fft.rfft(u, size)) * np.fft.rfft(y, size), size)[lags]
    counts = len(u) - np.abs(lags)
    first = np.maximum(lags, 0)

    def sums(values: Array, begin: Rows) -> Array:
        total = np.concatenate([[0.0], np.cumsum(values)])
        return np.asarray(total[begin + counts] - total[begin])

    sum_u, sum_y = sums(u, first - lags), sums(y, first)
    power_u = sums(u**2, first - lags) - sum_u**2 / counts
    power_y = sums(y**2, first) - sum_y**2 / counts
    scale = np.sqrt(np.maximum(power_u * power_y, 0.0))
    return np.asarray((cross - sum_u * sum_y / counts) / np.maximum(scale, 1e-300))


def _starts(
    record: SignalRecord, lag: float, rows: Rows
) -> Iterator[tuple[AbstractFollower, float]]:
    """Yield each model but a copy with the best of some delays and time constants."""
    step = record.step
    logs = [math.log(t * step) for t in _TIMES]
    families = (
        [Lagged((log,), "a first-order lag") for log in logs],
        [
            Lagged((log, math.log(zeta)), "a second-order lag", Lags.second_order)
            for log in logs
            for zeta in (0.5, 1.2)
        ],
        [Lagged((log,), "a lag and an integrator", angle=True) for log in logs],
    )
    longest = _LONGEST * record.time[-1]
    delays = sorted({min(d * step, longest) for d in _SHIFTS} | {max(lag, 0.0)})
    part = replace(
        record, **{name: getattr(record, name)[:_SCANNED] for name in ("time", "command", "output")}
    )
    part_rows = rows[rows < len(part.time)]

    def missed(pair: tuple[AbstractFollower, float]) -> float:
        error = fit_errors(part, *pair, part_rows)
        return float(error @ error)

    for family in families:
        yield min(((lagged, delay) for lagged in family for delay in delays), key=missed)


def _parts(fit: DelayFit) -> Iterator[tuple[float, Estimate]]:
    """Yield the delay in parts of the record, with the dynamics of the full record."""
    edges = np.arange(_PARTS + 1) * len(fit.rows) // _PARTS
    noise = float(fit.errors @ fit.errors) / max(len(fit.errors) - len(fit.follower.shape) - 3, 1)
    total = float(fit.sensitivity @ fit.sensitivity)
    quantile = student_quantile(len(fit.errors), joint_level(_PARTS))
    for first, last in pairwise(edges.tolist()):
        # A part without motion tells nothing about a delay.
        if float(np.sum(fit.sensitivity[first:last] ** 2)) <= total / _PARTS**2:
            continue
        rows = fit.rows[first:last]
        middle = float(fit.record.time[rows].mean())
        if isinstance(fit.follower, HeldCopy):
            yield middle, _held_interval(fit, rows, joint_level(_PARTS))
            continue
        delay, power = _own_delay(fit, rows)
        if power:
            half = quantile * math.sqrt(noise / power)
            yield middle, Estimate(delay, delay - half, delay + half + _hidden(fit))


def _own_delay(fit: DelayFit, rows: Rows) -> tuple[float, float]:
    """Return the least-squares delay of some rows in samples, and its squared sensitivity."""
    delay, power = fit.samples, 0.0
    for _ in range(_PART_STEPS):
        later_output, early = (fit.output(delay + d)[rows] for d in (_PART_SHIFT, -_PART_SHIFT))
        slope = (later_output - early) / (2 * _PART_SHIFT)
        power = float(slope @ slope)
        if not power:
            break
        error = fit.record.output[rows] - fit.output(delay)[rows]
        delay += float(np.clip(slope @ error / power, -2.0, 2.0))
    return delay, power


def _part_of_other_frequencies(record: SignalRecord) -> float:
    """Return the fraction of the command's power outside its best-fitting sinusoid."""
    from scipy.optimize import minimize_scalar

    time, command = record.time, record.command - record.command.mean()
    count, grid = len(command), np.linspace(time[0], time[-1], len(command))
    spectrum = np.abs(np.fft.rfft(np.interp(grid, time, command)))
    bin_ = 1 / (count * float(grid[1] - grid[0]))
    peak = bin_ * max(int(np.argmax(spectrum[1:])) + 1, 1)

    def missed(frequency: float) -> float:
        phase = 2 * math.pi * frequency * time
        columns = np.column_stack([np.sin(phase), np.cos(phase), np.ones(count)])
        residuals = command - columns @ np.linalg.lstsq(columns, command, rcond=None)[0]
        return float(residuals @ residuals)

    # A frequency between bins is within one of the largest.
    result = minimize_scalar(
        missed, bounds=(max(peak - bin_, bin_ / 4), peak + bin_), method="bounded"
    )
    return float(result.fun) / max(float(command @ command), np.finfo(float).tiny)


def _rivals(result: DelayIdentification) -> Iterator[str]:
    """Yield models that explain the record nearly as well with quite another delay."""
    if result.one_frequency:
        yield (
            f"{result.record.names[0]} has one frequency, which cannot separate a delay from a "
            "lag; record a motion of several frequencies"
        )
        return
    half = (result.interval.high - result.interval.low) / 2
    for fit in result.fits:
        other = abs(fit.samples - result.fit.samples) > half + 1
        if fit.bic <= result.fit.bic + _CLEARLY and other:
            yield (
                f"{fit.follower.name} with a delay of {max(fit.samples, 0.0):.3g} samples explains "
                "it nearly as well: this record does not tell a delay from a lag"
            )


def _doubts(result: DelayIdentification) -> Iterator[str]:
    """Yield what speaks against the chosen delay."""
    record, fit, untold = result.record, result.fit, result.untold
    command, output = record.names
    yield from doubt_step(record.step)
    yield from question_sizes([("delay", "the delay", result.delay.value, "s")])
    early, error = -fit.samples, (result.interval.high - result.interval.low) / 2
    if untold is not None:
        yield f"the delay is {untold}"
        # The correlation still tells which column comes first.
        early, error = -result.peak[0] / record.step, 1.0
    if early > error:
        yield (
            f"{output} comes {early:.3g} samples before {command}: the columns are swapped, or "
            "their clocks differ"
        )
    if fit.gain < 0:
        yield f"{output} moves against {command}: their signs are opposite"
    if fit.missed_part > _MISSED and fit.uncertainty.whiteness < WHITE:
        missed = f"{100 * fit.missed_part:.2g} %"
        yield f"the model misses {missed} of the motion, in errors that are not noise"
    jitter = float(np.ptp(np.diff(record.time))) / record.step
    if jitter > 0.1:
        yield f"the steps of time vary by {100 * jitter:.0f} %: a sample is no unit of time here"
    estimates = [part for _, part in result.parts]
    earliest = min(estimates, key=lambda part: part.high, default=None)
    latest = max(estimates, key=lambda part: part.low, default=None)
    if earliest and latest and earliest.high + _NOTABLE < latest.low:
        yield (
            f"the delay varies: at most {earliest.outward(3).high:g} samples in one part of the "
            f"record, at least {latest.outward(3).low:g} in another"
        )
