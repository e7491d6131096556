"""Whether stiffnesses of the range explain the torques of a log: the test of the monitor in C."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, floor, inf

import numpy as np

from nrs_design.api.audit import AuditCheck
from nrs_design.controllers.sector import DETECTION_FACTOR, Sector
from nrs_design.identification.numeric import Array, Flags, runs
from nrs_design.identification.running.bounds import RunBounds
from nrs_design.identification.running.log import RunLog
from nrs_design.identification.statistics import span

# Relative rounding error of an angle, and of a number of the size of the noise.
_ROUNDING = 2.0**-48
# Rows further apart than this number of periods leave samples out.
_LONGEST_STEP = 1.5
# Tolerance of an age, as a fraction of the time between rows.
_AGE_TOLERANCE = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class _Rows:
    """What the rows say, shape (n,) each."""

    # lowest, highest: between which a row leaves the surface; infinite where it says nothing.
    lowest: Array
    highest: Array
    # least, most: torque, with its noise.
    torque_low: Array
    torque_high: Array
    # first, last: angle at which it was measured, with its noise.
    first: Array
    last: Array


def judge_sector(log: RunLog, bounds: RunBounds) -> tuple[tuple[AuditCheck, ...], float | None]:
    """Hold a log against the range of stiffness.

    The checks are of the stiffness, and of the speed where the spec bounds it; the share is of the
    rows in which `DETECTION_FACTOR` times the range would have been told, None where nothing tells.
    """
    sector, columns = bounds.sector, _columns(log, bounds)
    if columns is None:
        words = "no columns for angle and torque, nor for deflection and force with a lever arm"
        return (AuditCheck("stiffness", "not judged", words),), None
    if isinstance(sector, str):
        return (AuditCheck("stiffness", "not judged", sector),), None
    basis = "proved range" if bounds.proved else "range of the spec, not proved"
    limit_text = span(float(sector.low), float(sector.high), "N m/rad", 5)
    interval = bounds.period or bounds.oldest or inf
    if (bounds.oldest or sector.surface != "fixed") and log.step > _LONGEST_STEP * interval:
        words = "rows are missing that the age of a torque, or a contact, is told by: log all"
        return (AuditCheck("stiffness", "not judged", words, limit_text, basis),), 0.0
    rows = _rows(log, columns, sector, ceil(bounds.oldest / log.step - _AGE_TOLERANCE))
    certain = rows.torque_low > 0
    first, is_judged = inf, np.zeros(len(log.time), dtype=np.bool_)
    for begin, end in _contacts(log, certain, sector):
        left, is_judged[begin:end] = _one_surface(log, rows, (begin, end), sector)
        first = min(first, left)
    pulled = np.flatnonzero((rows.torque_high < 0) & (not sector.contact_maintained))
    first = min(first, float(pulled[0]) if len(pulled) else inf)
    # After a violation, the surface is unknown.
    is_judged[int(min(first, len(is_judged))) :] = False
    share = float((is_judged & certain).mean())
    check = _stiffness(log, columns[1], first, share, limit_text, basis)
    return (check, *_speed(log, columns[0], sector, basis)), share


def _columns(log: RunLog, bounds: RunBounds) -> tuple[Array, Array] | None:
    """Return angle and torque at the pivot."""
    columns, arm = log.columns, bounds.lever_arm
    if {"angle", "torque"} <= columns.keys():
        return columns["angle"], columns["torque"]
    if {"deflection", "force"} <= columns.keys() and arm is not None:
        return columns["deflection"] / arm, columns["force"] * arm
    return None


def _rows(log: RunLog, columns: tuple[Array, Array], sector: Sector, old: int) -> _Rows:
    angle, torque = columns
    noise, error = float(sector.torque_noise), float(sector.angle_noise)
    low, high = float(sector.low), float(sector.high)
    size = np.abs(angle).max() + np.abs(torque).max() / low
    margin = error * (1 + _ROUNDING) + _ROUNDING * float(size)
    shifts = [np.concatenate([np.full(k, np.nan), angle[: len(angle) - k]]) for k in range(old + 1)]
    # Before the log, and before a gap, an angle is not known: NaN stays NaN.
    first, last = np.min(shifts, axis=0) - margin, np.max(shifts, axis=0) + margin
    for k in np.flatnonzero(log.gaps):
        first[k + 1 : k + 1 + old] = last[k + 1 : k + 1 + old] = np.nan
    torque_low, torque_high = torque - noise * (1 + _ROUNDING), torque + noise * (1 + _ROUNDING)
    lowest = first - np.maximum(torque_high / low, torque_high / high)
    highest = last - np.minimum(torque_low / low, torque_low / high)
    unknown = np.isnan(first)
    return _Rows(
        np.where(unknown, -inf, lowest),
        np.where(unknown | ~((torque_low > 0) | sector.contact_maintained), inf, highest),
        *(torque_low, torque_high, first, last),
    )


def _contacts(log: RunLog, certain: Flags, sector: Sector) -> Iterator[tuple[int, int]]:
    """Yield first row and end of stretches in which the surface stands still."""
    count = len(certain)
    if sector.surface == "fixed" or sector.contact_maintained:
        yield 0, count
        return
    breaks = np.flatnonzero(log.gaps) + 1
    for begin, end in runs(certain):
        cuts = [begin, *breaks[(breaks > begin) & (breaks < end)].tolist(), end]
        for part, (first, last) in enumerate(pairwise(cuts)):
            # The last row in the air tells where the surface is not, unless a gap follows it.
            still = sector.surface == "free" and not part and first > 0 and first not in breaks
            yield first - still, last


def _one_surface(
    log: RunLog, rows: _Rows, ends: tuple[int, int], sector: Sector
) -> tuple[float, Flags]:
    """Return the first row that leaves no surface (else infinity), and which rows are judged."""
    part = slice(*ends)
    drift = float(sector.surface_speed) * log.time[part]
    lowest = np.maximum.accumulate(rows.lowest[part] + drift)
    highest = np.minimum.accumulate(rows.highest[part] - drift)
    empty = np.flatnonzero(lowest - drift > highest + drift)
    # Both bounds come from earlier rows: an outlier would shift its own interval.
    before = np.concatenate([[-inf], lowest[:-1]]) - drift
    after = np.concatenate([[inf], highest[:-1]]) + drift
    factor, low, high = float(DETECTION_FACTOR), float(sector.low), float(sector.high)
    with np.errstate(invalid="ignore"):
        is_below = rows.torque_high[part] < factor * high * (rows.first[part] - after)
        is_above = rows.torque_low[part] > low / factor * (rows.last[part] - before)
    return ends[0] + float(empty[0]) if len(empty) else inf, is_below & is_above


def _stiffness(
    log: RunLog, torque: Array, first: float, share: float, limit_text: str, basis: str
) -> AuditCheck:
    percent = floor(1000 * share) / 10
    factor = float(DETECTION_FACTOR)
    note = f"{factor:g} times the range would have been detected in {percent:g} % of the rows"
    if first == inf:
        words = f"the range explains every row; {note}"
        return AuditCheck("stiffness", "undecided", words, limit_text, basis)
    words = f"no stiffness of the range explains {torque[int(first)]:.4g} N m and the rows before"
    time = log.time_of(first)
    return AuditCheck("stiffness", "outside", note, limit_text, basis, time, words)


def _speed(log: RunLog, angle: Array, sector: Sector, basis: str) -> Iterator[AuditCheck]:
    """Judge the speed of the joint, where the spec says one for its readings."""
    if sector.speed is None:
        return
    name, limit = "speed of the joint", float(sector.speed)
    limit_text = f"up to {limit:.4g} rad/s"
    # Stamps may be early or late where the samples are not.
    step = np.maximum(np.diff(log.time), log.step)
    size = np.abs(np.diff(angle))
    noise = 2 * float(sector.reading) + _ROUNDING * float(np.abs(angle).max())
    rows_above = np.flatnonzero(size > limit * step * (1 + 1e-9) + noise)
    measured = f"at least {max(float(size.max()) - noise, 0.0):.3g} rad in a row"
    if not len(rows_above):
        yield AuditCheck(name, "inside", measured, limit_text, basis)
        return
    row = int(rows_above[0])
    words = f"{size[row]:.3g} rad in {step[row]:.3g} s"
    yield AuditCheck(name, "outside", measured, limit_text, basis, log.time_of(row + 1), words)
