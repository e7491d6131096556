"""TRUSTED: which modes are in force at which steps of a round, and which signals keep to that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import compress, pairwise

from nrs_design.proof.switching import Clock
from nrs_design.proof.system import SwitchedSystem


def on_turn(system: SwitchedSystem, clock: Clock, step: int) -> SwitchedSystem:
    """Return a system with the modes alone that are in force at a step of a round.

    What disturbs it stays: the rows of roundings are over the states and all disturbances.

    Parameters
    ----------
    system : SwitchedSystem
        Whose modes take turns.
    clock : Clock
        Of the system.
    step : int
        Zero for the first.
    """
    first = frozenset(clock.first)
    kept = [(mode.name in first) == (step == 0) for mode in system.every_mode]
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
    )


def keeps_turns(clock: Clock, steps: Sequence[tuple[str, Fraction]]) -> bool:
    """Tell whether a signal that is repeated without end lets every mode take its turn.

    Parameters
    ----------
    clock : Clock
        Of a system.
    steps : sequence of (str, Fraction)
        Modes with whole numbers of steps, in order.
    """
    first, at, begins = frozenset(clock.first), Fraction(0), list[Fraction]()
    for name, count in steps:
        if name in first:
            if count != 1:
                return False
            begins.append(at)
        at += count
    if not begins:
        return False
    # After the end of the signal, it begins again.
    rounds = pairwise((*begins, begins[0] + at))
    return all(end - begin == clock.length for begin, end in rounds)
