"""TRUSTED: which modes are in force at which steps of a round, and which signals keep to that."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import compress

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
    free = () if system.contact is None else system.contact.free
    first = frozenset(clock.first)
    kept = [(mode.name in first) == (step == 0) for mode in (*system.modes, *free)]
    flying = kept[len(system.modes) :]
    contact = system.contact
    if contact is not None:
        contact = replace(contact, free=tuple(compress(free, flying)))
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
    first = frozenset(clock.first)
    # What comes before the first of them ends the last round, as it is a period.
    rounds, ahead = list[Fraction](), Fraction(0)
    for name, count in steps:
        if name not in first:
            if rounds:
                rounds[-1] += count
            else:
                ahead += count
        elif count != 1:
            return False
        else:
            rounds.append(Fraction(1))
    if not rounds:
        return False
    rounds[-1] += ahead
    return all(count == clock.length for count in rounds)
