"""Stiffness and contact, estimated window by window; they decide nothing.

A window shows how much the torque changes with the angle: a tangent. A spec bounds their ratio, a
secant, and a stiffness that varies inside its range shows any tangent. So no estimate of these is
called inside or outside.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf

import numpy as np

from nrs_design.identification.numeric import Array, Flags, runs
from nrs_design.identification.running.bounds import RunBounds
from nrs_design.identification.running.check import BoundStatus, Check
from nrs_design.identification.running.log import RunLog
from nrs_design.identification.running.stiffness import Window, cut_windows, stiffness_of
from nrs_design.identification.statistics import span
from nrs_design.proof.text import counted

ESTIMATE = (
    "a window shows how much the torque changes with the angle, and the range bounds their ratio"
)
# Less than this part of the least stiffness is no contact.
_FREE = 0.1
# Fewer readings of zero in a row are noise that is rounded, or a force that changes its sign.
_ZEROS = 3
# So many windows in which force and deflection oppose each other are no accident.
_OPPOSED = 0.5


@dataclass(frozen=True, slots=True, eq=False)
class ContactEstimate:
    """What a log shows of stiffness and contact."""

    checks: tuple[Check, Check]  # Stiffness and contact
    # Those in which something moves while a torque acts; stiffness at the pivot in N m/rad.
    windows: tuple[Window, ...]
    # Of the time of the log, in how much of it the windows, or a torque of exactly zero, tell
    # something.
    share: float


def estimate_contact(
    log: RunLog, bounds: RunBounds, length: float, *, losable: bool | None
) -> ContactEstimate:
    """Estimate stiffness and contact in windows of a length in s.

    Whether contact may be lost is None if nothing says it.
    """
    reason = _missing(log, bounds)
    if reason:
        return _not_estimated(reason)
    turn = 1.0
    x, f = log.columns.get("angle"), log.columns.get("torque")
    if x is None or f is None:
        turn = (bounds.lever_arm or 1.0) ** 2
        x, f = log.columns["deflection"], log.columns["force"]
    zero = _rests_at_zero(f)
    felt = _felt(log, bounds)
    windows = [
        replace(w, value=w.value * turn, low=w.low * turn, high=w.high * turn)
        for w in stiffness_of(log.time, x, f, [*_spans(log, zero, felt, length)])
    ]
    told = tuple(w for w in windows if w.high < inf)
    if sum(w.high < 0 for w in told) > _OPPOSED * len(told):
        reason = "force and deflection have opposite signs; turn one with another column"
        return replace(_not_estimated(reason), windows=told)
    free = [w for w in told if _is_free(w, bounds, log)]
    # Where the slope may be zero and may be that of a contact, a window tells neither.
    touching = [w for w in told if w not in free and (w.low > 0 or w.high < 0)]
    # A log with gaps has fewer rows than its time has steps.
    whole = max(float(log.time[-1] - log.time[0]) / log.step + 1, float(len(log.time)))
    loose = (int((zero & felt).sum()) + _rows(free)) / whole
    kept = _rows(touching) / whole
    checks = _stiffness(log, bounds, touching), _contact(bounds, loose, kept, losable)
    return ContactEstimate(checks, told, loose + kept)


def _rests_at_zero(force: Array) -> Flags:
    """Tell in which rows a sensor reads exactly zero: free motion, and no stiffness of zero."""
    zero: Flags = np.asarray(force == 0.0)
    for first, last in runs(zero):
        zero[first:last] = last - first >= _ZEROS
    return zero


def _rows(windows: list[Window]) -> int:
    return sum(w.last - w.first for w in windows)


def _felt(log: RunLog, bounds: RunBounds) -> Flags:
    """Tell in which rows the controller in force may touch something."""
    if log.modes is None:
        return np.ones(len(log.time), dtype=bool)
    felt = np.array([bounds.stiffness[label] is not None for label in log.labels], dtype=bool)
    return np.asarray(felt[log.modes])


def _spans(log: RunLog, zero: Flags, felt: Flags, length: float) -> Iterator[tuple[int, int]]:
    """Yield windows in one mode in which a torque acts and something may be touched."""
    modes = np.zeros(len(zero), dtype=np.int64) if log.modes is None else log.modes
    for first, last in cut_windows(log.time, 2 * modes + zero, length):
        if felt[first] and not zero[first]:
            yield first, last


def _missing(log: RunLog, bounds: RunBounds) -> str:
    """Say why no window tells a stiffness, or nothing."""
    if not {"angle", "torque"} <= log.columns.keys():
        if not {"deflection", "force"} <= log.columns.keys():
            turning = {"angle", "torque"} & log.columns.keys()
            pair = ("angle", "torque") if turning else ("deflection", "force")
            gone = [name for name in pair if name not in log.columns]
            return f"no column for {' and '.join(gone)}"
        if bounds.lever_arm is None:
            return "the log is linear, and the spec names no lever arm that all environments share"
    unknown = [label for label in log.labels if label not in bounds.stiffness]
    if unknown:
        known = ", ".join(bounds.stiffness)
        return f"{unknown[0]!r} is no controller of the spec, which has {known}"
    foreign = {n for s in bounds.stiffness.values() if s is not None for n in s.foreign}
    if foreign:
        return f"{', '.join(sorted(foreign))} remembers: a window has no stiffness of its own"
    if all(s is None for s in bounds.stiffness.values()):
        return "no controller has contact"
    if log.modes is None and None in bounds.stiffness.values():
        return "no column for mode, and not every controller has contact"
    return ""


def _is_free(window: Window, bounds: RunBounds, log: RunLog) -> bool:
    named = bounds.stiffness if log.modes is None else [log.labels[log.modes[window.first]]]
    least = min((low for low, _ in bounds.ranges_of(named)), default=0.0)
    return max(abs(window.low), abs(window.high)) < _FREE * least


def _stiffness(log: RunLog, bounds: RunBounds, touching: list[Window]) -> Check:
    basis = "proved range" if bounds.proved else "range of the spec, not proved"
    ranges = bounds.ranges_of(log.labels or bounds.stiffness)
    allowed = " or ".join(span(*ends, "N m/rad", 5) for ends in ranges)
    if not touching:
        words = "no window in contact in which something moves"
        return Check.open("stiffness", words, allowed, basis)
    values = [w.value for w in touching]
    count = counted(len(values), "window")
    words = f"slopes of {span(min(values), max(values), 'N m/rad')} in {count}"
    return Check("stiffness", BoundStatus.ESTIMATED, words, allowed, basis)


def _contact(bounds: RunBounds, free: float, kept: float, losable: bool | None) -> Check:
    words = f"about {100 * free:.3g} % of the time free, {100 * kept:.3g} % in contact"
    if losable:
        basis = "covered by the proof" if bounds.proved else "asked for by the spec, not proved"
        return Check("contact", BoundStatus.INSIDE, words, "lost and made again at any time", basis)
    if losable is None:
        basis = "`contact` of the spec, or a certificate, says whether it may be lost"
        return Check("contact", BoundStatus.ESTIMATED, words, "not said", basis)
    basis = f"assumption of {bounds.source}"
    return Check("contact", BoundStatus.ESTIMATED, words, "kept all the time", basis)


def _not_estimated(reason: str) -> ContactEstimate:
    stiffness, contact = (Check.open(name, reason) for name in ("stiffness", "contact"))
    return ContactEstimate((stiffness, contact), (), 0.0)
