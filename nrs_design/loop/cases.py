"""Systems in cases: each case is one part of the ranges of constant parameters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import chain

from nrs_design.errors import AssemblyError
from nrs_design.proof.channels import Channel, Rounding
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Mode
from nrs_design.proof.switching import ARBITRARY
from nrs_design.proof.system import SwitchedSystem


def in_cases(whole: SwitchedSystem, parts: Sequence[SwitchedSystem]) -> SwitchedSystem:
    """Return the system with the parts as cases, under arbitrary switching in each.

    `whole` is that of all parts together. Signals that saturate are left out, and rules of
    switching, which allow less. An `AssemblyError` if a switch moves the state, or the parts differ
    in more than modes.
    """
    if whole.switching.resets or any(part.states != whole.states for part in parts):
        raise AssemblyError("parts of ranges share no state, or a switch moves it")
    contact, clock, flights = whole.contact, whole.clock, whole.flights
    if contact is not None:
        contact = replace(contact, free=_every(part.free for part in parts))
    if clock is not None:
        clocks = [part.clock for part in parts if part.clock]
        more = zip(*(own.more for own in clocks), strict=True)
        first = _named(own.first for own in clocks)
        clock = replace(clock, first=first, more=tuple(map(_named, more)))
    if flights is not None:
        flights = replace(
            flights,
            touching=_named(part.flights.touching for part in parts if part.flights),
            flying=_named(part.flights.flying for part in parts if part.flights),
        )
    return replace(
        whole,
        modes=_every(part.modes for part in parts),
        switching=ARBITRARY,
        contact=contact,
        clock=clock,
        flights=flights,
        channels=tuple(_channels(whole, parts)),
        roundings=tuple(_roundings(whole, parts)),
        saturation=None,
        enclosures=(),
        cases=tuple(
            tuple(name_in_case(mode.name, k) for mode in part.every_mode)
            for k, part in enumerate(parts)
        ),
    )


def name_in_case(name: str, case: int) -> str:
    """Name a mode in a case; cases count from zero, and their names from one."""
    return f"{name}/case-{case + 1}"


def _named(each: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(name_in_case(name, k) for k, names in enumerate(each) for name in names)


def _every(each: Iterable[tuple[Mode, ...]]) -> tuple[Mode, ...]:
    return tuple(
        replace(mode, name=name_in_case(mode.name, k))
        for k, modes in enumerate(each)
        for mode in modes
    )


def _channels(whole: SwitchedSystem, parts: Sequence[SwitchedSystem]) -> Iterator[Channel]:
    for i, channel in enumerate(whole.channels):
        columns = [part.channels[i].columns for part in parts]
        yield replace(channel, columns=_joined(parts, columns))


def _roundings(whole: SwitchedSystem, parts: Sequence[SwitchedSystem]) -> Iterator[Rounding]:
    for i, item in enumerate(whole.roundings):
        columns = [part.roundings[i].columns for part in parts]
        rows = [part.roundings[i].rows for part in parts]
        yield replace(item, columns=_joined(parts, columns), rows=_joined(parts, rows))


def _joined(
    parts: Sequence[SwitchedSystem], each: Sequence[tuple[RationalMatrix, ...]]
) -> tuple[RationalMatrix, ...]:
    """Return the items of the contact modes of all parts, then those of the free modes."""
    pairs = [(items, len(part.modes)) for part, items in zip(parts, each, strict=True)]
    touching = (items[:count] for items, count in pairs)
    return tuple(chain.from_iterable((*touching, *(items[count:] for items, count in pairs))))
