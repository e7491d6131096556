"""The delay between two columns of a record."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np

from nrs_design.errors import DataError
from nrs_design.identification.datasets.checks import (
    FEWEST_ROWS,
    doubt_step,
    gaps_in,
    pauses_text,
)
from nrs_design.identification.datasets.records import SignalRecord
from nrs_design.identification.delay.fit import EXACT, DelayFit, errors_at, fit_delay, fit_held
from nrs_design.identification.delay.models import (
    AbstractFollower,
    HeldCopy,
    SmoothCopy,
    first_order,
    integrator,
    second_order,
)
from nrs_design.identification.numeric import Array, Rows
from nrs_design.identification.statistics import (
    WHITE,
    Estimate,
    independent,
    joint_level,
    student_quantile,
)
from nrs_design.identification.tables.table import Source
from nrs_design.spec.plausible import doubt_size

# Largest delay that is looked for, as a part of the record.
_LONGEST = 0.1
# A delay beside a lag is found to so many samples.
_OFF = 2e-3
# So near to a whole number, only the arithmetic of a fit without noise keeps a delay from it.
_SAME = Fraction(1, 10**6)
_PARTS = 10
_PART_STEPS = 6
# A model with more parameters must lower BIC by so much (very strong evidence: Kass and Raftery
# 1995).
_CLEARLY = 10.0
# In samples: a difference for derivatives, and one that is worth a word.
_PART_SHIFT = 0.05
_NOTABLE = 0.1
# Below this correlation the columns have nothing to do with each other.
_RELATED = 0.2
# Model misses so much of the motion, in errors that are not white: that is a doubt.
_MISSED = 0.02
# And of so much, no interval that is made for noise says anything.
_UNEXPLAINED = 0.1
# A command whose power is in one frequency, but for so much, has one phase to tell.
_OTHER = 0.01
# Where a spline through every other sample misses those between by more than this part of the
# change from sample to sample, a command is not smooth between its samples.
_SMOOTH = 0.05
# Samples about the whole record's delay in which that of a part is sought.
_AROUND = 50
# Rows before a pause that a spline across it may miss, and after it that the command before may
# reach.
_BEFORE, _AFTER = 5, 5
_TIMES = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
_SHIFTS = (0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
_SCANNED = 5000


@dataclass(frozen=True, slots=True, eq=False)
class DelayIdentification:
    """What a record says about a delay."""

    record: SignalRecord  # The data
    fits: tuple[DelayFit, ...]  # One for each model
    chosen: DelayFit  # The simplest of those whose BIC none clearly beats
    samples: Estimate  # The delay in samples of the record, with a 95 % interval
    # Lag in s at which both columns are most alike, lag of the dynamics included, and their
    # correlation there.
    peak: tuple[float, float]
    # The delay in samples in parts of the record, by their middle in s, at 95 % for all of them
    # together.
    parts: tuple[tuple[float, Estimate], ...]
    # Whether the command is smooth between samples, so that a copy tells parts of them. Otherwise,
    # or beside a lag, nobody knows when within a sample a logged command began: the interval is a
    # sample wide, at least.
    smooth: bool
    # From and to, in samples: they hold the interval and every part of the record. Where errors are
    # not noise, they hold those of a copy, too: then a lag may stand for a part of the delay. Of a
    # command of one frequency, they hold all from zero to those of a copy.
    held: tuple[float, float]
    untold: str | None  # Why the record does not tell the delay, if it does not
    doubts: tuple[str, ...]  # What speaks against it

    @property
    def delay(self) -> Estimate:
        """In s, with a 95 % interval."""
        return self.samples.scaled(self.record.step)

    @property
    def whole_samples(self) -> tuple[int, int]:
        """What is held, in whole samples of the record."""
        return self.in_periods(Fraction(self.record.step))

    @property
    def is_lag(self) -> bool:
        """Whether dynamics lie between the columns: they leave nothing but noise."""
        return not self._is_copy and self.chosen.uncertainty.whiteness >= WHITE

    @property
    def _is_copy(self) -> bool:
        return isinstance(self.chosen.follower, SmoothCopy | HeldCopy)

    @property
    def sources(self) -> tuple[Source, ...]:
        """The file."""
        return (self.record.source,)

    @property
    def remarks(self) -> tuple[str, ...]:
        """What the interval rests on, in words."""
        said = pauses_text(self.record.time)
        if isinstance(self.chosen.follower, SmoothCopy):
            rests = f"{self.record.names[0]} is smooth between samples: parts of a sample are told"
        else:
            rests = (
                f"the record does not tell when within a sample {self.record.names[0]} changed: no "
                "interval is below a sample"
            )
        return (rests,) if said is None else (said, rests)

    @property
    def caveats(self) -> tuple[str, ...]:
        """Doubts, and dynamics that make the delay more than the age of a sample."""
        if self._is_copy:
            return self.doubts
        sent, seen = self.record.names
        name = self.chosen.follower.name
        return (
            *self.doubts,
            f"{name} fits better between {sent} and {seen} than a mere delay",
        )

    def in_periods(self, period: Fraction) -> tuple[int, int]:
        """Return what is held, in whole periods of another length in s, rounded outward."""
        low, high = (end / period for end in self.held_s)
        return math.floor(low + _SAME), math.ceil(high - _SAME)

    @property
    def held_s(self) -> tuple[Fraction, Fraction]:
        """What is held, in s."""
        low, high = (Fraction(end) * Fraction(self.record.step) for end in self.held)
        return low, high


def identify_delay(record: SignalRecord) -> DelayIdentification:
    """Find the delay by cross-correlation, then by a fit beside the dynamics."""
    peak = correlation_peak(record)
    if abs(peak[1]) < _RELATED:
        raise DataError(
            f"{record.names[1]} does not follow {record.names[0]}: their largest correlation is "
            f"{peak[1]:.2f}",
            path=record.source.path,
            remedy="name other columns with --command and --measured, or record a livelier motion",
        )
    rows = _reached(record, peak[0])
    smooth = is_smooth(record)
    copy = (
        fit_delay(record, SmoothCopy(), peak[0], rows)
        if smooth
        else fit_held(record, peak[0], rows)
    )
    others = (fit_delay(record, *start, rows) for start in _starts(record, peak[0], rows))
    # A search may leave the delays that are looked for.
    fits = (copy, *(fit for fit in others if abs(fit.delay) <= _longest(record)))
    chosen = _simplest(fits)
    _check_explained(record, chosen)
    value, told = chosen.delay / record.step, _interval(record, chosen)
    half = (told.high - told.low) / 2
    # A delay is not negative; what is left of an interval is a sample where one is the least.
    low = max(told.low, 0.0)
    samples = Estimate(max(value, 0.0), low, max(told.high, low + _unknown(chosen), 0.0))
    parts, untold = tuple(_parts(record, chosen)), _untold(record, samples)
    held = [samples, *(part for _, part in parts)]
    one_frequency = _other_than_one_frequency(record) < _OTHER
    if one_frequency:
        held.append(Estimate(0.0, 0.0, 0.0))
    if one_frequency or chosen.uncertainty.whiteness < WHITE:
        held += [part for _, part in _parts(record, copy)]
    ends = max(min(e.low for e in held), 0.0), max(*(e.high for e in held), 0.0)
    doubts = (
        *_rivals(record, fits, chosen, half, one_frequency=one_frequency),
        *_doubts(record, chosen, half, peak[0], parts, untold),
    )
    return DelayIdentification(
        record, fits, chosen, samples, peak, parts, smooth, ends, untold, doubts
    )


def _check_explained(record: SignalRecord, fit: DelayFit) -> None:
    """Refuse a model that misses much of the motion: its delay may be any.

    Of a held command, the part of a sample is open: to be a sample late misses as much as the
    motion changes in a sample.
    """
    missed, allowed = _missed_part(record, fit), _UNEXPLAINED
    if not is_smooth(record):
        seen = record.seen[fit.rows]
        change = np.linalg.norm(np.diff(seen)) / np.linalg.norm(seen - seen.mean())
        allowed = max(allowed, float(change))
    if missed <= allowed or fit.uncertainty.whiteness >= WHITE:
        return
    raise DataError(
        f"no delay, with or without a lag, explains {record.names[1]} by {record.names[0]}: the "
        f"best misses {100 * missed:.2g} % of the motion, in errors that are not noise",
        path=record.source.path,
        remedy=f"delays up to {_longest(record):.3g} s are looked for, a tenth of the record: make "
        "it ten times as long as the delay may be; or a stretch of it in which the delay does not "
        "vary",
    )


def _longest(record: SignalRecord) -> float:
    """Return the longest delay that is looked for, in s."""
    return _LONGEST * float(np.ptp(record.time[record.longest]))


def _missed_part(record: SignalRecord, fit: DelayFit) -> float:
    """Return the root mean square of the errors over that of the motion."""
    seen = record.seen[fit.rows]
    return float(np.linalg.norm(fit.errors) / np.linalg.norm(seen - seen.mean()))


def is_smooth(record: SignalRecord) -> bool:
    """Tell whether a command is smooth between samples, so that a spline knows it there.

    Every other sample must tell those between them: it does of a measured motion, and does not of a
    command that is held or steps, nor of noise.
    """
    from scipy.interpolate import CubicSpline

    missed, moved = 0.0, 0.0
    for rows in record.stretches:
        time, sent = record.time[rows], record.sent[rows]
        if len(time) < 8:
            continue
        # At both ends, a spline is free.
        between = CubicSpline(time[::2], sent[::2])(time[1::2]) - sent[1::2]
        missed += 2 * float(np.sum(between[2:-2] ** 2))
        moved += float(np.sum(np.diff(sent) ** 2))
    return missed <= _SMOOTH**2 * moved


def _reached(record: SignalRecord, lag: float) -> Rows:
    """Return the rows that no command from before the record, or a pause of it, can reach."""
    skipped = max(lag, 0.0) + _AFTER * record.step
    kept = []
    for number, rows in enumerate(record.stretches):
        time = record.time[rows]
        inside = np.flatnonzero(time >= time[0] + skipped) + rows.start
        kept.append(inside if number == len(record.stretches) - 1 else inside[:-_BEFORE])
    found = np.concatenate(kept)
    if len(found) < FEWEST_ROWS:
        raise DataError(
            f"{len(found)} rows are later than the largest correlation after its beginning, or a "
            f"pause, at least {FEWEST_ROWS} are needed",
            path=record.source.path,
            remedy="record longer without a pause",
        )
    return found


def _interval(record: SignalRecord, fit: DelayFit) -> Estimate:
    """Return the delay in samples with its 95 % interval; it may be below zero."""
    value = fit.delay / record.step
    if isinstance(fit.follower, HeldCopy):
        return _held_interval(record, fit, fit.rows, joint_level(1))
    half = student_quantile(fit.uncertainty.degrees) * float(fit.uncertainty.errors[0])
    if unknown := _unknown(fit):
        # A search ends a little off, also where no noise shows it.
        half = max(half, _OFF)
    return Estimate(value, value - half, value + half + unknown)


def _unknown(fit: DelayFit) -> float:
    """Return by how much longer a delay may be, in samples, than a fit to logged commands says.

    A command is logged up to a sample after it began. Only a copy of one that is smooth in between
    does not ask when that was.
    """
    return 0.0 if isinstance(fit.follower, SmoothCopy) else 1.0


def _held_interval(record: SignalRecord, fit: DelayFit, rows: Rows, confidence: float) -> Estimate:
    """Return the best whole number of samples, and all delays that the rows do not reject.

    That a copy is k samples late says of its delay that it is between k - 1 and k + 1: the command
    began up to a sample before it was logged, and its copy, too.
    """
    from scipy.special import chdtri

    late = round(fit.delay / record.step) + np.arange(-_AROUND, _AROUND + 1)
    errors = [record.seen[rows] - fit.output(record, k * record.step)[rows] for k in late]
    powers = np.array([float(error @ error) for error in errors])
    best = int(np.argmin(powers))
    # Neighbours that are alike count less; and without noise, rounding decides nothing.
    count = max(independent(errors[best]), 1.0)
    least = max(float(powers[best]), EXACT * float(np.sum(record.seen[rows] ** 2)))
    kept = late[powers <= least * np.exp(float(chdtri(1, 1 - confidence)) / count)]
    low, high = float(min(kept, default=late[best])), float(max(kept, default=late[best]))
    return Estimate(float(late[best]), low - 1.0, high + 1.0)


def _simplest(fits: Sequence[DelayFit]) -> DelayFit:
    """Return the fit with the fewest parameters among those that none clearly beats.

    A fast second lag and a delay are nearly alike: chance alone would choose it now and then, and
    its interval for the delay would not hold.
    """
    least = min(fit.bic for fit in fits)
    good = [fit for fit in fits if fit.bic <= least + _CLEARLY]
    return min(good, key=lambda fit: (len(fit.follower.shape), fit.bic))


def correlation_peak(record: SignalRecord) -> tuple[float, float]:
    """Return the lag in s at which both columns are most alike, and their correlation there.

    Columns are compared by their changes where those are alike more clearly, which is so for
    columns that drift.
    """
    found = [_peak(record, difference=difference) for difference in (False, True)]
    return max(found, key=lambda pair: abs(pair[1]))


def _peak(record: SignalRecord, *, difference: bool) -> tuple[float, float]:
    rows = record.longest
    time = record.time[rows]
    count = len(time)
    even = np.linspace(time[0], time[-1], count)
    u, y = (np.interp(even, time, values[rows]) for values in (record.sent, record.seen))
    if difference:
        u, y = np.diff(u), np.diff(y)
    longest = max(int(_LONGEST * count), 2)
    lags = np.arange(-longest, longest + 1)
    alike = _correlations(u - np.mean(u), y - np.mean(y), lags)
    best = int(np.argmax(np.abs(alike)))
    return float(lags[best]) * float(even[1] - even[0]), float(alike[best])


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
    times = [t * step for t in _TIMES]
    families: list[list[AbstractFollower]] = [
        [first_order(math.log(t)) for t in times],
        [second_order(math.log(t), math.log(z)) for t in times for z in (0.5, 1.2)],
        [integrator(math.log(t)) for t in times],
    ]
    longest = _LONGEST * record.time[-1]
    delays = sorted({min(d * step, longest) for d in _SHIFTS} | {max(lag, 0.0)})
    part = replace(
        record, **{name: getattr(record, name)[:_SCANNED] for name in ("time", "sent", "seen")}
    )
    inside = rows[rows < len(part.time)]
    for family in families:
        pairs = [(follower, delay) for follower in family for delay in delays]
        yield min(pairs, key=lambda pair: _missed(part, pair[0], pair[1], inside))


def _missed(record: SignalRecord, follower: AbstractFollower, delay: float, rows: Rows) -> float:
    error = errors_at(record, follower, delay, rows)
    return float(error @ error)


def _parts(record: SignalRecord, fit: DelayFit) -> Iterator[tuple[float, Estimate]]:
    """Yield the delay in parts of the record, beside the dynamics of the whole."""
    edges = np.arange(_PARTS + 1) * len(fit.rows) // _PARTS
    noise = float(fit.errors @ fit.errors) / max(len(fit.errors) - len(fit.follower.shape) - 3, 1)
    total = float(fit.sensitivity @ fit.sensitivity)
    quantile = student_quantile(len(fit.errors), joint_level(_PARTS))
    for first, last in pairwise(edges.tolist()):
        # A part without motion tells nothing about a delay.
        if float(np.sum(fit.sensitivity[first:last] ** 2)) <= total / _PARTS**2:
            continue
        rows = fit.rows[first:last]
        middle = float(record.time[rows].mean())
        if isinstance(fit.follower, HeldCopy):
            yield middle, _held_interval(record, fit, rows, joint_level(_PARTS))
            continue
        own, power = _own_delay(record, fit, rows)
        if power:
            half = quantile * math.sqrt(noise / power)
            yield middle, Estimate(own, own - half, own + half + _unknown(fit))


def _own_delay(record: SignalRecord, fit: DelayFit, rows: Rows) -> tuple[float, float]:
    """Return the delay in samples that fits some rows best, and how much they tell about it."""
    own, power = fit.delay / record.step, 0.0
    for _ in range(_PART_STEPS):
        late, early = (
            fit.output(record, (own + d) * record.step)[rows] for d in (_PART_SHIFT, -_PART_SHIFT)
        )
        slope = (late - early) / (2 * _PART_SHIFT)
        power = float(slope @ slope)
        if not power:
            break
        error = record.seen[rows] - fit.output(record, own * record.step)[rows]
        own += float(np.clip(slope @ error / power, -2.0, 2.0))
    return own, power


def _rivals(
    record: SignalRecord,
    fits: Sequence[DelayFit],
    chosen: DelayFit,
    half: float,
    *,
    one_frequency: bool,
) -> Iterator[str]:
    """Yield what explains the record nearly as well with quite another delay."""
    if one_frequency:
        yield (
            f"{record.names[0]} has one frequency: a delay and a lag cannot be told apart by it; "
            "record a motion of several"
        )
        return
    for fit in fits:
        samples = (fit.delay - chosen.delay) / record.step
        if fit.bic <= chosen.bic + _CLEARLY and abs(samples) > half + 1:
            yield (
                f"{fit.follower.name} with a delay of {max(fit.delay / record.step, 0.0):.3g} "
                "samples explains it nearly as well: this record does not tell a delay from a "
                "lag"
            )


def _other_than_one_frequency(record: SignalRecord) -> float:
    """Return which part of the command's power no swing of one frequency explains."""
    from scipy.optimize import minimize_scalar

    time, sent = record.time[record.longest], record.sent[record.longest]
    sent = sent - sent.mean()
    count, even = len(sent), np.linspace(time[0], time[-1], len(sent))
    spectrum = np.abs(np.fft.rfft(np.interp(even, time, sent)))
    bin_ = 1 / (count * float(even[1] - even[0]))
    near = bin_ * max(int(np.argmax(spectrum[1:])) + 1, 1)

    def missed(frequency: float) -> float:
        phase = 2 * math.pi * frequency * time
        columns = np.column_stack([np.sin(phase), np.cos(phase), np.ones(count)])
        rest = sent - columns @ np.linalg.lstsq(columns, sent, rcond=None)[0]
        return float(rest @ rest)

    # A frequency between bins is within one of the largest.
    found = minimize_scalar(
        missed, bounds=(max(near - bin_, bin_ / 4), near + bin_), method="bounded"
    )
    return float(found.fun) / max(float(sent @ sent), np.finfo(float).tiny)


def _untold(record: SignalRecord, samples: Estimate) -> str | None:
    """Say that an interval is longer than its record: it is no number to show without a doubt."""
    length = float(np.ptp(record.time))
    if (samples.high - samples.low) * record.step <= length:
        return None
    return f"not told by this record: its interval is longer than the {length:.3g} s"


def _doubts(
    record: SignalRecord,
    fit: DelayFit,
    half: float,
    peak: float,
    parts: Sequence[tuple[float, Estimate]],
    untold: str | None,
) -> Iterator[str]:
    yield from doubt_step(record.step)
    value = fit.delay / record.step
    late = max(value, 0.0) * record.step
    if asked := doubt_size("delay", late, "s"):
        yield f"the delay is {late:.4g} s: {asked}"
    if untold is not None:
        yield f"the delay is {untold}"
    # Where the fit tells nothing, the correlation still tells which column comes first.
    early = -value if untold is None else -peak / record.step
    if early > (half if untold is None else 1.0):
        yield (
            f"{record.names[1]} comes {early:.3g} samples before {record.names[0]}: the columns "
            "are swapped, or their clocks differ"
        )
    if fit.gain < 0:
        yield f"{record.names[1]} moves against {record.names[0]}: their signs are opposite"
    missed = _missed_part(record, fit)
    if missed > _MISSED and fit.uncertainty.whiteness < WHITE:
        yield f"the model misses {100 * missed:.2g} % of the motion, in errors that are not noise"
    steps = np.diff(record.time)
    jitter = float(np.ptp(steps[~gaps_in(record.time)])) / record.step
    if jitter > 0.1:
        yield f"the steps of time vary by {100 * jitter:.0f} %: a sample is no unit of time here"
    earliest = min((part for _, part in parts), key=lambda part: part.high, default=None)
    latest = max((part for _, part in parts), key=lambda part: part.low, default=None)
    if earliest and latest and earliest.high + _NOTABLE < latest.low:
        yield (
            f"the delay varies: at most {earliest.outward(3).high:g} samples in one part of the "
            f"record, at least {latest.outward(3).low:g} in another"
        )
