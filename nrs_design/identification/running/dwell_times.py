"""Dwell times and the order of controllers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf

import numpy as np

from nrs_design.api.audit import AuditCheck
from nrs_design.identification.numeric import Rows, parted
from nrs_design.identification.running.bounds import RunBounds
from nrs_design.identification.running.log import RunLog
from nrs_design.identification.statistics import span
from nrs_design.proof.text import counted

_NAME = "dwell times"
# Longest step of a log, in periods, that leaves no sample out.
_LONGEST_STEP = 1.5


@dataclass(frozen=True, slots=True)
class _Stay:
    """A stay in one mode, with switches known to a row; the log may cut its begin or end."""

    mode: str  # The controller
    begin: float  # Time of its first row, in s
    # shortest, longest: bounds of its length in s, with the time before the log.
    shortest: float
    longest: float
    logged: float  # Longest possible length within the log, in s
    ended: bool  # Whether a switch within the log ended the stay
    gap: bool  # Whether rows are missing within or next to the stay


def judge_stays(log: RunLog, bounds: RunBounds) -> AuditCheck:
    """Judge times in each mode, and the order of modes."""
    limit_text, basis = _rules_text(bounds), f"switching rules of {bounds.source}"
    if bounds.names_contacts:
        reason = "the rules name contacts, and a log does not say what is touched"
        return AuditCheck(_NAME, "not judged", reason, "", basis)
    if (modes := log.modes) is None:
        if not limit_text:
            return AuditCheck(_NAME, "inside", "any switching is allowed", "arbitrary", basis)
        return AuditCheck(_NAME, "not judged", "no column for mode", limit_text, basis)
    dwells = list(_stays(log, modes))
    unknown = [stay.mode for stay in dwells if stay.mode not in bounds.dwell_times]
    if unknown:
        reason = f"{unknown[0]!r} is no controller of the spec"
        return AuditCheck(_NAME, "not judged", reason, limit_text, basis)
    measured = counted(len(dwells) - 1, "switch")
    if not limit_text:
        return AuditCheck(_NAME, "inside", measured, "arbitrary", basis)
    step = float(np.diff(log.time).max())
    # With a row for every sample of the loop, no stay is shorter.
    if bounds.period is None or step > _LONGEST_STEP * bounds.period:
        measured += f"; a stay between two rows (up to {step:.3g} s) is not seen"
    if (first := next(_violations(dwells, bounds), None)) is not None:
        return AuditCheck(_NAME, "outside", measured, limit_text, basis, *first)
    if (doubt := next(_doubts(dwells, bounds), None)) is not None:
        return AuditCheck(_NAME, "undecided", f"{measured}; {doubt}", limit_text, basis)
    return AuditCheck(_NAME, "inside", measured, limit_text, basis)


def _rules_text(bounds: RunBounds) -> str:
    rules = []
    for name, (shortest, longest) in bounds.dwell_times.items():
        if shortest > 0:
            rules.append(f"{name} at least {shortest:g} s")
        if longest < inf:
            rules.append(f"{name} at most {longest:g} s")
    if bounds.transitions is not None:
        rules.append(counted(len(bounds.transitions), "transition"))
    return ", ".join(rules)


def _stays(log: RunLog, modes: Rows) -> Iterator[_Stay]:
    time = log.begin + log.time
    # No switch is before the first row, and none after the last.
    before, after = np.append(time[0], time), np.append(time, time[-1])
    for first, last in parted(np.diff(modes) != 0):
        ended = last < len(time)
        begin, logged = float(time[first]), float(after[last] - before[first])
        yield _Stay(
            mode=log.labels[modes[first]],
            begin=begin,
            shortest=float(time[last - 1]) - begin,
            longest=logged if first and ended else inf,
            logged=logged,
            ended=ended,
            gap=bool(log.gaps[max(first - 1, 0) : last].any()),
        )


def _violations(dwells: list[_Stay], bounds: RunBounds) -> Iterator[tuple[float, str]]:
    """Yield time in s and text of each violation that is certain."""
    before = ""
    for stay in dwells:
        shortest, longest = bounds.dwell_times[stay.mode]
        transitions = bounds.transitions
        ordered = transitions is None or not before or (before, stay.mode) in transitions
        if not ordered and not stay.gap:
            yield stay.begin, f"{before} was followed by {stay.mode}"
        if stay.longest < shortest:
            words = f"{stay.mode} lasted {stay.longest:.4g} s at most, not {shortest:g} s"
            yield stay.begin, words
        if stay.shortest > longest and not stay.gap:
            words = f"{stay.mode} lasted {stay.shortest:.4g} s at least, not {longest:g} s"
            yield stay.begin, words
        before = stay.mode


def _doubts(dwells: list[_Stay], bounds: RunBounds) -> Iterator[str]:
    """Yield what some reading of the log does not allow."""
    for place, stay in enumerate(dwells):
        shortest, longest = bounds.dwell_times[stay.mode]
        if stay.gap:
            yield f"rows are missing about {stay.begin:.6g} s, where switches may have been"
        if stay.ended and stay.shortest < shortest:
            lasted = span(stay.shortest, stay.longest, "s")
            if not place:
                lasted = f"{stay.shortest:.4g} s at least: the log begins with it"
            yield f"from {stay.begin:.6g} s on {stay.mode} lasted {lasted}"
        if stay.logged > longest:
            lasted = span(stay.shortest, stay.logged, "s")
            yield f"from {stay.begin:.6g} s on {stay.mode} lasted {lasted}"
