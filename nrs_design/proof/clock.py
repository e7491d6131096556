"""TRUSTED: schedules of modes, and the signals that follow them."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem

# For each state the next one; None where there is none.
Leads: TypeAlias = tuple[int | None, ...]


def on_turn(system: SwitchedSystem, clock: Clock, kind: int) -> SwitchedSystem:
    """Return a system whose modes take turns with the modes of one kind alone."""
    names = [mode.name for mode in system.every_mode]
    selection = (name for name, k in zip(names, clock.kind_of(names), strict=True) if k == kind)
    return system.only(frozenset(selection))


def keeps_turns(clock: Clock, steps: Sequence[tuple[str, Fraction]]) -> bool:
    """Tell whether a signal may be repeated without end, from some state.

    Its steps are whole numbers. Where it leads from each state is a map of states. If it can be
    made as often as there are states, it has come back to a state at which it began, and goes on
    for ever.
    """
    states = range(clock.length)
    maps = [tuple(clock.after(k, kind) for k in states) for kind in clock.kinds]
    whole: Leads = tuple(states)
    for kind, (_, count) in zip(clock.kind_of(name for name, _ in steps), steps, strict=True):
        whole = _then(whole, _repeated(maps[kind], int(count)))
    return any(state is not None for state in _repeated(whole, clock.length))


def _then(first: Leads, second: Leads) -> Leads:
    """Return the composition of two maps, the first one first."""
    return tuple(None if state is None else second[state] for state in first)


def _repeated(leads: Leads, count: int) -> Leads:
    """Return the power of a map."""
    result: Leads = tuple(range(len(leads)))
    for bit in bin(count)[2:]:
        result = _then(result, result)
        if bit == "1":
            result = _then(result, leads)
    return result
