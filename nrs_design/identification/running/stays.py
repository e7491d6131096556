"""How long each controller was active, and what followed it."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np

from nrs_design.identification.running.bounds import RunBounds
from nrs_design.identification.running.check import BoundStatus, Check, Violation
from nrs_design.identification.running.log import RunLog
from nrs_design.proof.text import counted

_NAME = "dwell times"


@dataclass(frozen=True, slots=True)
class _Stay:
    """A time in one mode; a log tells switches to a row, and not what was before and after it."""

    mode: str
    begin: float
    shortest: float
    longest: float


def judge_stays(log: RunLog, bounds: RunBounds) -> Check:
    """Judge times in each mode, and the order of modes.

    Parameters
    ----------
    log : RunLog
        The data.
    bounds : RunBounds
        What the spec promises.
    """
    allowed, basis = _allowed(bounds), f"switching rules of {bounds.source}"
    if bounds.names_contacts:
        reason = "the rules name contacts, and a log does not say what is touched"
        return Check(_NAME, BoundStatus.NOT_JUDGED, reason, "", basis)
    if log.modes is None:
        if not allowed:
            return Check(_NAME, BoundStatus.INSIDE, "any switching is allowed", "arbitrary", basis)
        return Check(_NAME, BoundStatus.NOT_JUDGED, "no column for mode", allowed, basis)
    stays = list(_stays(log))
    unknown = [stay.mode for stay in stays if stay.mode not in bounds.stays]
    if unknown:
        reason = f"{unknown[0]!r} is no controller of the spec"
        return Check(_NAME, BoundStatus.NOT_JUDGED, reason, allowed, basis)
    measured = "1 switch" if len(stays) == 2 else f"{len(stays) - 1} switches"
    first = next(_violations(stays, bounds), None)
    status = BoundStatus.INSIDE if first is None else BoundStatus.OUTSIDE
    return Check(_NAME, status, measured, allowed or "arbitrary", basis, first)


def _allowed(bounds: RunBounds) -> str:
    rules = []
    for name, (shortest, longest) in bounds.stays.items():
        if shortest > 0:
            rules.append(f"{name} at least {shortest:g} s")
        if longest < inf:
            rules.append(f"{name} at most {longest:g} s")
    if bounds.transitions is not None:
        rules.append(counted(len(bounds.transitions), "transition"))
    return ", ".join(rules)


def _stays(log: RunLog) -> Iterator[_Stay]:
    modes = log.modes
    if modes is None:
        return
    time = log.begin + log.time
    edges = [0, *(np.flatnonzero(np.diff(modes)) + 1).tolist(), len(modes)]
    for first, last in itertools.pairwise(edges):
        begin, end = float(time[first]), float(time[last - 1])
        # The switches before and after lie somewhere between two rows.
        earliest = float(time[first - 1]) if first else begin
        latest = float(time[last]) if last < len(time) else inf
        longest = latest - earliest if first and last < len(time) else inf
        yield _Stay(log.labels[modes[first]], begin, end - begin, longest)


def _violations(stays: list[_Stay], bounds: RunBounds) -> Iterator[Violation]:
    """Yield what no reading of the log allows."""
    before = ""
    for stay in stays:
        shortest, longest = bounds.stays[stay.mode]
        allowed = bounds.transitions
        if before and allowed is not None and (before, stay.mode) not in allowed:
            yield Violation(stay.begin, f"{before} was followed by {stay.mode}")
        if stay.longest < shortest:
            yield Violation(
                stay.begin, f"{stay.mode} lasted {stay.longest:.4g} s at most, not {shortest:g} s"
            )
        if stay.shortest > longest:
            words = f"{stay.mode} lasted {stay.shortest:.4g} s at least, not {longest:g} s"
            yield Violation(stay.begin, words)
        before = stay.mode
