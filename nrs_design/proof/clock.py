"""TRUSTED: which modes may be in force at which steps, and which signals keep to that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import compress
from typing import TypeAlias

from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem

# For each state, where something leads; None where it may not be.
Leads: TypeAlias = tuple[int | None, ...]


def on_turn(system: SwitchedSystem, clock: Clock, *, first: bool) -> SwitchedSystem:
    """Return a system whose modes take turns with the modes of one kind alone.

    What disturbs it stays: the rows of roundings are over the states and all disturbances.
    """
    names = frozenset(clock.first)
    kept = [(mode.name in names) is first for mode in system.every_mode]
    flying = kept[len(system.modes) :]
    contact = system.contact
    if contact is not None:
        contact = replace(contact, free=tuple(compress(contact.free, flying)))
    roundings = (
        replace(
            item,
            columns=tuple(compress(item.columns, kept)),
            rows=tuple(compress(item.rows, kept)),
        )
        for item in system.roundings
    )
    channels = (
        replace(item, columns=tuple(compress(item.columns, kept))) for item in system.channels
    )
    return replace(
        system,
        modes=tuple(compress(system.modes, kept)),
        contact=contact,
        roundings=tuple(roundings),
        channels=tuple(channels),
        saturation=None,
        clock=None,
        enclosures=tuple(item for item in system.enclosures if (item[0] in names) is first),
    )


def keeps_turns(clock: Clock, steps: Sequence[tuple[str, Fraction]]) -> bool:
    """Tell whether a signal may be repeated without end, from some state.

    Its steps are whole numbers. Where it leads from each state is a map of states. If it can be
    made as often as there are states, it has come back to a state at which it began, and goes on
    for ever.
    """
    first = frozenset(clock.first)
    states = range(clock.length)
    once = {kind: tuple(clock.after(k, first=kind) for k in states) for kind in (True, False)}
    whole: Leads = tuple(states)
    for name, count in steps:
        whole = _then(whole, _repeated(once[name in first], int(count)))
    return any(state is not None for state in _repeated(whole, clock.length))


def _then(one: Leads, other: Leads) -> Leads:
    """Return where two maps lead, one after the other."""
    return tuple(None if state is None else other[state] for state in one)


def _repeated(leads: Leads, count: int) -> Leads:
    """Return where a map leads that is made so many times."""
    result: Leads = tuple(range(len(leads)))
    for bit in bin(count)[2:]:
        result = _then(result, result)
        if bit == "1":
            result = _then(result, leads)
    return result
