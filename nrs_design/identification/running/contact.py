"""Stiffness and contact, window by window."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nrs_design.identification.running.bounds import RunBounds, Stiffness
from nrs_design.identification.running.check import BoundStatus, Check, Violation
from nrs_design.identification.running.log import RunLog
from nrs_design.identification.running.stiffness import (
    FEWEST_ROWS,
    Window,
    cut_windows,
    stiffness_of,
)

Array = NDArray[np.float64]

# Less than this part of the least stiffness is no contact.
_FREE = 0.1
# Where contact may be lost, it is kept throughout a window if the force never falls below this part
# of its largest value there.
_KEPT = 0.25
# So many windows in which force and deflection oppose each other are no accident.
_OPPOSED = 0.5


@dataclass(frozen=True, slots=True)
class _Judged:
    window: Window
    allowed: Stiffness
    status: BoundStatus
    free: bool


def judge_contact(
    log: RunLog, bounds: RunBounds, length: float, *, losable: bool | None
) -> tuple[Check, Check, list[Window]]:
    """Judge stiffness and contact; a violation is claimed only where a whole interval is outside.

    Parameters
    ----------
    log : RunLog
        The data.
    bounds : RunBounds
        What the spec promises.
    length : float
        Of a window, in s.
    losable : bool or None
        Whether contact may be lost; None if nothing says it, so that no loss is a violation.
    """
    basis = "proved range" if bounds.proved else "range of the spec, not proved"
    reason = _missing(log, bounds)
    if reason:
        return _not_judged("stiffness", reason), _not_judged("contact", reason), []
    turn = 1.0
    x, f = log.columns.get("angle"), log.columns.get("torque")
    if x is None or f is None:
        turn = (bounds.lever_arm or 1.0) ** 2
        x, f = log.columns["deflection"], log.columns["force"]
    spans = list(cut_windows(log.time, log.modes, length))
    windows = [
        replace(w, value=w.value * turn, low=w.low * turn, high=w.high * turn)
        for w in stiffness_of(log.time, x, f, spans)
    ]
    found = (_judge(log, bounds, w) for w in windows)
    judged = [item for item in found if item is not None]
    if losable is not False:
        # Partly free, a window has a stiffness that no tissue has.
        judged = [_doubted(item, f) for item in judged]
    told = [w for w in windows if w.low > -np.inf]
    if told and sum(w.high < 0 for w in told) > _OPPOSED * len(told):
        reason = "force and deflection have opposite signs; turn one with another column"
        return _not_judged("stiffness", reason), _not_judged("contact", reason), windows
    if losable:
        contact = _losable(bounds, judged)
    elif losable is None:
        contact = _unsaid(judged, windows)
    else:
        contact = _contact(log, bounds, judged, windows)
    return _stiffness(log, bounds, judged, basis), contact, windows


def _rows_outside_windows(log: RunLog, bounds: RunBounds, judged: list[_Judged]) -> int:
    """Return how many rows no window holds, of those in which something may be touched."""
    touching = np.ones(len(log.time), dtype=bool)
    if log.modes is not None:
        felt = [bounds.stiffness[label] is not None for label in log.labels]
        touching = np.array(felt)[log.modes]
    for item in judged:
        touching[item.window.first : item.window.last] = False
    return int(touching.sum())


def _missing(log: RunLog, bounds: RunBounds) -> str:
    """Say why no window tells a stiffness, or nothing."""
    if {"angle", "torque"} <= log.columns.keys():
        return _strangers(log, bounds)
    if not {"deflection", "force"} <= log.columns.keys():
        turning = {"angle", "torque"} & log.columns.keys()
        pair = ("angle", "torque") if turning else ("deflection", "force")
        gone = [name for name in pair if name not in log.columns]
        return f"no column for {' and '.join(gone)}"
    if bounds.lever_arm is None:
        return "the log is linear, and the spec names no lever arm that all environments share"
    return _strangers(log, bounds)


def _strangers(log: RunLog, bounds: RunBounds) -> str:
    """Say which names of modes are none of the spec, or which law no window tells."""
    unknown = [label for label in log.labels if label not in bounds.stiffness]
    if unknown:
        known = ", ".join(bounds.stiffness)
        return f"{unknown[0]!r} is no controller of the spec, which has {known}"
    foreign = {n for s in bounds.stiffness.values() if s is not None for n in s.foreign}
    if foreign:
        return f"{', '.join(sorted(foreign))} remembers: a window has no stiffness of its own"
    if all(s is None for s in bounds.stiffness.values()):
        return "no controller has contact"
    if log.modes is None and bounds.stiffness_in(None) is None:
        return "no column for mode, and not every controller has contact"
    return ""


def _judge(log: RunLog, bounds: RunBounds, window: Window) -> _Judged | None:
    """Judge one window; None in a mode without contact."""
    modes = log.modes
    mode = None if modes is None else log.labels[modes[window.first]]
    allowed = bounds.stiffness_in(mode)
    if allowed is None:
        return None
    least = min(low for low, _ in allowed.ranges)
    # Where the log does not say which controller is active, it may be any.
    active = [allowed] if mode is not None else [s for s in bounds.stiffness.values() if s]
    if all(_is_inside(window, stiffness) for stiffness in active):
        return _Judged(window, allowed, BoundStatus.INSIDE, free=False)
    if all(window.high < low or window.low > high for low, high in allowed.ranges):
        return _Judged(window, allowed, BoundStatus.OUTSIDE, free=_is_free(window, least))
    return _Judged(window, allowed, BoundStatus.UNDECIDED, free=False)


def _is_inside(window: Window, stiffness: Stiffness) -> bool:
    return any(low <= window.low and window.high <= high for low, high in stiffness.ranges)


def _doubted(item: _Judged, force: Array) -> _Judged:
    """Return a window without its violation, if contact may have been lost in it."""
    f = force[item.window.first : item.window.last]
    size = np.abs(f)
    kept = abs(np.sign(f).sum()) == len(f) and size.min() >= _KEPT * size.max()
    told = item.free or kept or item.status is not BoundStatus.OUTSIDE
    return item if told else replace(item, status=BoundStatus.UNDECIDED)


def _is_free(window: Window, least: float) -> bool:
    return max(abs(window.low), abs(window.high)) < _FREE * least


def _stiffness(log: RunLog, bounds: RunBounds, judged: list[_Judged], basis: str) -> Check:
    touching = [item for item in judged if not item.free]
    ranges = dict.fromkeys(pair for item in judged for pair in item.allowed.ranges)
    allowed = " or ".join(f"{low:.5g} to {high:.5g} N m/rad" for low, high in ranges)
    outside = [item for item in touching if item.status is BoundStatus.OUTSIDE]
    inside = [item for item in touching if item.status is BoundStatus.INSIDE]
    open_ends = len(touching) - len(outside) - len(inside)
    if not touching:
        return Check("stiffness", BoundStatus.NOT_JUDGED, "no window in contact", allowed, basis)
    measured = f"{len(inside)} of {len(touching)} windows inside, {len(outside)} outside"
    measured += f", {open_ends} undecided" if open_ends else ""
    if open_ends and log.modes is None and len(bounds.stiffness) > 1:
        measured += " (no column for mode: inside is what is so whichever controller is active)"
    unseen = _rows_outside_windows(log, bounds, judged)
    if unseen:
        measured += f"; {unseen} of {len(log.time)} rows in no window: a stay, or what is between "
        measured += f"two gaps, has fewer than {FEWEST_ROWS}"
    if outside:
        w = outside[0].window
        words = f"k = {w.value:.4g} [{w.low:.4g}, {w.high:.4g}] N m/rad"
        first = Violation(log.begin + float(log.time[w.first]), words)
        return Check("stiffness", BoundStatus.OUTSIDE, measured, allowed, basis, first)
    status = BoundStatus.UNDECIDED if open_ends or unseen else BoundStatus.INSIDE
    return Check("stiffness", status, measured, allowed, basis)


def _losable(bounds: RunBounds, judged: list[_Judged]) -> Check:
    basis = "covered by the proof" if bounds.proved else "asked for by the spec, not proved"
    allowed = "lost and made again at any time"
    return Check("contact", BoundStatus.INSIDE, _count(judged), allowed, basis)


def _unsaid(judged: list[_Judged], windows: list[Window]) -> Check:
    status = BoundStatus.INSIDE if _is_kept(judged, windows) else BoundStatus.UNDECIDED
    basis = "`contact` of the spec, or a certificate, says whether it may be lost"
    return Check("contact", status, _count(judged), "not said", basis)


def _contact(log: RunLog, bounds: RunBounds, judged: list[_Judged], windows: list[Window]) -> Check:
    allowed, basis = "kept all the time", f"assumption of {bounds.source}"
    free = [item for item in judged if item.free]
    if not free:
        status = BoundStatus.INSIDE if _is_kept(judged, windows) else BoundStatus.UNDECIDED
        return Check("contact", status, _count(judged), allowed, basis)
    w = free[0].window
    words = f"k = {w.value:.3g} [{w.low:.3g}, {w.high:.3g}] N m/rad: free motion"
    first = Violation(log.begin + float(log.time[w.first]), words)
    return Check("contact", BoundStatus.OUTSIDE, _count(judged), allowed, basis, first)


def _is_kept(judged: list[_Judged], windows: list[Window]) -> bool:
    """Tell whether every window shows contact."""
    whole = bool(judged) and len(judged) == len(windows)
    return whole and not any(item.free or _may_be_free(item) for item in judged)


def _may_be_free(item: _Judged) -> bool:
    return item.status is BoundStatus.UNDECIDED and item.window.low <= 0


def _count(judged: list[_Judged]) -> str:
    """Say how many windows have no contact, and of how many that cannot be told."""
    free, untold = sum(item.free for item in judged), sum(map(_may_be_free, judged))
    measured = f"{free} of {len(judged)} windows without contact"
    return measured + (f", {untold} undecided" if untold else "")


def _not_judged(name: str, reason: str) -> Check:
    return Check(name, BoundStatus.NOT_JUDGED, reason, "", "")
