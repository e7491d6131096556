"""A system beside itself, as two cases, of which one is there for ever."""

from dataclasses import replace
from itertools import accumulate

from nrs_design.proof.evidence import FormsOnGraph
from nrs_design.proof.evidence.graph import Multiplier, Node, at_place
from nrs_design.proof.mode import Time

BOTH = 0, 1


def _named(names):
    return tuple(f"{name}/case-{k + 1}" for k in BOTH for name in names)


def _modes(modes):
    return tuple(replace(mode, name=f"{mode.name}/case-{k + 1}") for k in BOTH for mode in modes)


def twice(system):
    """Return a system as two cases, with the items of contact modes before those of free ones."""
    contact, clock, flights = system.contact, system.clock, system.flights

    def items(each):
        n = len(system.modes)
        return *each[:n] * 2, *each[n:] * 2

    if contact is not None:
        contact = replace(contact, free=_modes(contact.free))
    if clock is not None:
        more = tuple(map(_named, clock.more))
        clock = replace(clock, first=_named(clock.first), more=more)
    if flights is not None:
        touching, flying = _named(flights.touching), _named(flights.flying)
        flights = replace(flights, touching=touching, flying=flying)
    return replace(
        system,
        modes=_modes(system.modes),
        contact=contact,
        clock=clock,
        flights=flights,
        channels=tuple(replace(one, columns=items(one.columns)) for one in system.channels),
        roundings=tuple(
            replace(one, columns=items(one.columns), rows=items(one.rows))
            for one in system.roundings
        ),
        cases=tuple(tuple(f"{m.name}/case-{k + 1}" for m in system.every_mode) for k in BOTH),
    )


def joined(system, parts):
    """Return the evidence on both cases of a system from that on each."""
    flows = system.time is Time.CONTINUOUS
    first = accumulate((len(part.nodes) for part in parts), initial=0)
    nodes = [Node(at_place(n.place, k), n.form) for k, part in enumerate(parts) for n in part.nodes]
    multipliers = [
        Multiplier(f"{item.fact}/case-{k + 1}" if flows else item.fact, item.value, begin + target)
        for k, (begin, part) in enumerate(zip(first, parts, strict=False))
        for item in part.multipliers
        for target in (range(len(part.nodes)) if item.target is None else [item.target])
    ]
    rate = min(part.rate for part in parts) if flows else max(part.rate for part in parts)
    return FormsOnGraph(
        tuple(nodes),
        max(part.denominator_log2 for part in parts),
        rate,
        multipliers=tuple(multipliers),
    )
