"""TRUSTED: whether the parts of a switched system make sense for each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from nrs_design.proof.channels import Rounding
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.saturation import MOST_SIGNALS, CutOff, Start
from nrs_design.proof.switching import NOWHERE, Clock
from nrs_design.proof.system import SwitchedSystem


def find_contradiction(system: SwitchedSystem) -> str | None:
    """TRUSTED: say why the parts of a system make no sense for each other, or None."""
    return next((said for odd in _ODDITIES for said in odd(system)), None)


def _odd_stay(system: SwitchedSystem) -> Iterator[str]:
    own = system.switching.stays
    names = {mode.name for mode in system.modes}
    if len(dict(own)) < len(own) or not dict(own).keys() <= names:
        yield "the dwell times are not those of modes"
    stays = system.stays()
    for name in dict(own):
        if (longest := stays[name].longest) is not None and longest < stays[name].shortest:
            yield f"mode {name} must be left before it may be"
    if min((system.switching.dwell_time, *(stay.shortest for _, stay in own))) < 0:
        yield "a dwell time is negative"


def _odd_switch(system: SwitchedSystem) -> Iterator[str]:
    names = {mode.name for mode in system.modes}
    for source, target in system.switching.transitions or ():
        if source == target or not {source, target} <= names:
            yield "a transition does not lead from one mode to another"
    for reset in system.switching.resets:
        if reset.source == reset.target or not {reset.source, reset.target} <= names:
            yield "a reset does not lead from one mode to another"
        if not reset.map.is_well_formed:
            yield "a reset is not a matrix over a positive denominator"


def _odd_ends(system: SwitchedSystem) -> Iterator[str]:
    sets = system.switching.fixed_ends
    names = {mode.name for mode in system.modes}
    ends = [name for corners in sets for name in set(corners)]
    if sets and (sorted(ends) != sorted(names) or len({*map(len, sets)}) > 1 or len(sets[0]) < 2):
        yield "the modes are not the ends of constant parameters"
    for parameter in system.switching.fixed_parameters:
        reversed_ = parameter.high < parameter.low
        if not sets or reversed_ or (parameter.inverse and parameter.low <= 0):
            yield f"constant parameter {parameter.name} has no range, or no modes"


def _odd_contact(system: SwitchedSystem) -> Iterator[str]:
    if system.contact is None:
        return
    n, free = system.order, system.contact.free
    names = {mode.name for mode in system.modes}
    if n < 2 or not system.is_uniform:
        yield "contact is lost, but the modes do not share a deflection beside other states"
    if not free or len({mode.name for mode in free} - names) < len(free):
        yield "contact is lost, but there is no free mode, or two modes have one name"
    if not all(_is_motion(mode.A, n, system.time) for mode in free):
        yield "the deflection acts on the other states in a free mode"
    yield from _odd_pulls(system, system.contact.pulls)


def _odd_flights(system: SwitchedSystem) -> Iterator[str]:
    if system.flights is None:
        return
    touching, flying = set(system.flights.touching), set(system.flights.flying)
    names = {mode.name for mode in system.modes}
    if system.contact is not None or not system.is_uniform:
        yield "free motion is among the modes and beside them, or they share no deflection"
    if touching & flying or not touching | flying <= names:
        yield "what is in contact or free is no mode, or is both"
    yield from _odd_pulls(system, system.flights.pulls)


def _odd_pulls(system: SwitchedSystem, pulls: tuple[RationalMatrix, ...]) -> Iterator[str]:
    if not all(q.is_well_formed and q.shape == (1, system.order) for q in pulls):
        yield "a force is not one row over a positive denominator"


def _odd_sample_time(system: SwitchedSystem) -> Iterator[str]:
    if system.sample_time is None:
        return
    if system.time is Time.CONTINUOUS or system.sample_time <= 0:
        yield "the time of a step is not positive, or there are no steps"


def _odd_channel(system: SwitchedSystem) -> Iterator[str]:
    n = system.order
    sized = [(c.name, M, (n, 1)) for c in system.channels for M in c.columns]
    sized += [(o.name, M, (1, n)) for o in system.outputs for M in o.rows]
    for name, M, shape in sized:
        if not M.is_well_formed or M.shape != shape:
            yield f"{name} does not have the size of the state"
    for channel in system.channels:
        if channel.bound <= 0 or len(channel.columns) != len(system.every_mode):
            yield f"{channel.name} has no positive bound, or not one column for every mode"
    if not all(output.rows for output in system.outputs):
        yield "an output has no rows"
    if any(output.limit is not None and output.limit <= 0 for output in system.outputs):
        yield "the limit of an output is not positive"
    names = [*(c.name for c in system.channels), *(o.name for o in system.outputs)]
    if len(set(names)) < len(names):
        yield "two disturbances or outputs have one name"


def _odd_rounding(system: SwitchedSystem) -> Iterator[str]:
    if system.roundings and system.time is Time.CONTINUOUS:
        yield "the arithmetic rounds, but there are no steps"
    width = system.order + len(system.channels)
    widths = [width] * len(system.roundings)
    yield from _odd_errors(system, system.roundings, "the rounding of ", widths)


def _odd_clock(system: SwitchedSystem) -> Iterator[str]:
    if system.clock is None:
        return
    if system.time is Time.CONTINUOUS or system.clock.length < 2 or not system.is_uniform:
        yield "modes take turns without steps, in rounds of less than two, or of unlike size"
    if not system.switching.is_arbitrary:
        yield "modes take turns, and have rules of switching besides"
    yield from _odd_automaton(system.clock)
    clock, every = system.clock, [mode.name for mode in system.every_mode]
    named = [name for own in (clock.first, *clock.more) for name in own]
    if not set(named) <= set(every) or len(set(named)) < len(named):
        yield "a mode that does not exist is to take its turn, or one is of two kinds"
    groups = [clock.kind_of(mode.name for mode in part) for part in (system.modes, system.free)]
    if not all({*group} == {*clock.kinds} for group in groups if group):
        yield "a turn has no mode, in contact or free"
    if any(len(set(clock.kind_of(names))) > 1 for names in system.enclosures):
        yield "what is between the modes of an enclosure is of two kinds that take turns"


def _odd_automaton(clock: Clock) -> Iterator[str]:
    if clock.is_round and not clock.more:
        return
    if [*map(len, clock.ahead)] != [len(clock.kinds)] * clock.length:
        yield "what may follow is not said of every state of an automaton"
    if any(not NOWHERE <= target < clock.length for leads in clock.ahead for target in leads):
        yield "a step leads to a state that the automaton does not have"
    if any(set(leads) == {NOWHERE} for leads in clock.ahead):
        yield "no mode may be in force in a state of an automaton"


def _odd_saturation(system: SwitchedSystem) -> Iterator[str]:
    if system.saturation is None:
        return
    signals = system.saturation.signals
    if not 1 <= len(signals) <= MOST_SIGNALS:
        yield f"no signal saturates, or more than {MOST_SIGNALS} do"
    widths = range(system.order, system.order + len(signals))
    yield from _odd_errors(system, signals, "", widths)
    for signal in signals:
        if signal.limit <= 0:
            yield f"the limit of {signal.name} is not positive"
        rows, width = signal.errors, len(system.roundings)
        if rows and len(rows) != len(system.every_mode):
            yield f"{signal.name} has not one row of what acts on it for every mode"
        if not all(row.is_well_formed and row.shape == (1, width) for row in rows):
            yield f"{signal.name} does not know what the arithmetic rounds"
    yield from _odd_start(system, system.saturation.start)


def _odd_start(system: SwitchedSystem, start: Start) -> Iterator[str]:
    states = start.states
    if not states or not all(x.is_well_formed and x.shape == (system.order, 1) for x in states):
        yield f"{start.name} does not have the size of the state"
    if not all(any(map(any, x.numerators)) for x in states):
        yield f"{start.name} stands for a state that is zero"
    # Where contact is lost, V is not x'Qx.
    if system.free and any(x.numerators[-1][0] < 0 for x in states):
        yield f"{start.name} stands for a state without contact"


def _odd_enclosure(system: SwitchedSystem) -> Iterator[str]:
    sizes = {mode.name: mode.A.shape for mode in system.every_mode}
    named = [name for names in system.enclosures for name in names]
    if not sizes.keys() >= set(named) or len(set(named)) < len(named):
        yield "an enclosure is not one of modes, or a mode is in two of them"
    if any(len({sizes[name] for name in names}) != 1 for names in system.enclosures):
        yield "an enclosure is empty, or its modes are not of one size"


def _odd_errors(
    system: SwitchedSystem,
    items: Sequence[Rounding | CutOff],
    said: str,
    widths: Iterable[int],
) -> Iterator[str]:
    """Say why columns and rows are not those of every mode and free mode."""
    n = system.order
    if items and not system.is_uniform:
        yield f"{said}{items[0].name} is of modes that are not of one size"
    for item, width in zip(items, widths, strict=True):
        sized = [*((M, (n, 1)) for M in item.columns), *((M, (1, width)) for M in item.rows)]
        if not all(M.is_well_formed and M.shape == shape for M, shape in sized):
            yield f"{said}{item.name} does not have the size of the state"
        if not len(item.columns) == len(item.rows) == len(system.every_mode):
            yield f"{said}{item.name} has not one column and row for every mode"
        if any(row.numerators[0][n - 1] for row in item.rows[len(system.modes) :]):
            yield f"{said}{item.name} depends on the deflection in free motion"
    names = [item.name for item in items]
    if len(set(names)) < len(names):
        yield f"{said}{names[0]} is said twice"


def _is_motion(A: RationalMatrix, order: int, time: Time) -> bool:
    """Tell whether a free mode has its shape, and the deflection only moves on from where it is."""
    if not A.is_well_formed or A.shape != (order, order):
        return False
    *others, last = (row[-1] for row in A.numerators)
    return not any(others) and last == (0 if time is Time.CONTINUOUS else A.denominator)


# In this order: what comes later may take for granted what comes before.
_ODDITIES = (
    _odd_stay,
    _odd_switch,
    _odd_ends,
    _odd_contact,
    _odd_flights,
    _odd_sample_time,
    _odd_channel,
    _odd_rounding,
    _odd_clock,
    _odd_saturation,
    _odd_enclosure,
)
