"""TRUSTED: whether the parts of a switched system make sense for each other."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from nrs_design.proof.channels import Rounding
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.saturation import MOST_SIGNALS, CutOff, Start
from nrs_design.proof.switching import NOWHERE, Clock
from nrs_design.proof.system import SwitchedSystem


def find_contradiction(system: SwitchedSystem) -> str | None:
    """TRUSTED: say why the rules of switching make no sense for these modes, or None."""
    names = {mode.name for mode in system.modes}
    return (
        _find_odd_stay(system, names)
        or _find_odd_switch(system, names)
        or _find_odd_ends(system, names)
        or _find_odd_contact(system, names)
        or _find_odd_flights(system, names)
        or _find_odd_sample_time(system)
        or _find_odd_channel(system)
        or _find_odd_rounding(system)
        or _find_odd_clock(system)
        or _find_odd_saturation(system)
        or _find_odd_enclosure(system)
        or _find_odd_case(system)
    )


def _find_odd_stay(system: SwitchedSystem, names: set[str]) -> str | None:
    own = system.switching.stays
    if len(dict(own)) < len(own) or not dict(own).keys() <= names:
        return "the dwell times are not those of modes"
    stays = system.stays()
    for name in dict(own):
        if (longest := stays[name].longest) is not None and longest < stays[name].shortest:
            return f"mode {name} must be left before it may be"
    if min((system.switching.dwell_time, *(stay.shortest for _, stay in own))) < 0:
        return "a dwell time is negative"
    return None


def _find_odd_switch(system: SwitchedSystem, names: set[str]) -> str | None:
    for source, target in system.switching.transitions or ():
        if source == target or not {source, target} <= names:
            return "a transition does not lead from one mode to another"
    for reset in system.switching.resets:
        if reset.source == reset.target or not {reset.source, reset.target} <= names:
            return "a reset does not lead from one mode to another"
        if not reset.map.is_well_formed:
            return "a reset is not a matrix over a positive denominator"
    return None


def _find_odd_ends(system: SwitchedSystem, names: set[str]) -> str | None:
    sets = system.switching.fixed_ends
    ends = [name for corners in sets for name in set(corners)]
    if sets and (sorted(ends) != sorted(names) or len({*map(len, sets)}) > 1 or len(sets[0]) < 2):
        return "the modes are not the ends of constant parameters"
    for parameter in system.switching.fixed_parameters:
        reversed_ = parameter.high < parameter.low
        if not sets or reversed_ or (parameter.inverse and parameter.low <= 0):
            return f"constant parameter {parameter.name} has no range, or no modes"
    return None


def _find_odd_contact(system: SwitchedSystem, names: set[str]) -> str | None:
    if system.contact is None:
        return None
    n, free = system.order, system.contact.free
    if n < 2 or not system.is_uniform:
        return "contact is lost, but the modes do not share a deflection beside other states"
    if not free or len({mode.name for mode in free} - names) < len(free):
        return "contact is lost, but there is no free mode, or two modes have one name"
    if not all(_is_motion(mode.A, n, system.time) for mode in free):
        return "the deflection acts on the other states in a free mode"
    return _find_odd_pulls(system, system.contact.pulls)


def _find_odd_flights(system: SwitchedSystem, names: set[str]) -> str | None:
    if system.flights is None:
        return None
    touching, flying = set(system.flights.touching), set(system.flights.flying)
    if system.contact is not None or not system.is_uniform:
        return "free motion is among the modes and beside them, or they share no deflection"
    if touching & flying or not touching | flying <= names:
        return "what is in contact or free is no mode, or is both"
    return _find_odd_pulls(system, system.flights.pulls)


def _find_odd_pulls(system: SwitchedSystem, pulls: tuple[RationalMatrix, ...]) -> str | None:
    if not all(q.is_well_formed and q.shape == (1, system.order) for q in pulls):
        return "a force is not one row over a positive denominator"
    return None


def _find_odd_sample_time(system: SwitchedSystem) -> str | None:
    if system.sample_time is None:
        return None
    if system.time is Time.CONTINUOUS or system.sample_time <= 0:
        return "the time of a step is not positive, or there are no steps"
    return None


def _find_odd_channel(system: SwitchedSystem) -> str | None:
    n = system.order
    sized = [(c.name, M, (n, 1)) for c in system.channels for M in c.columns]
    sized += [(o.name, M, (1, n)) for o in system.outputs for M in o.rows]
    for name, M, shape in sized:
        if not M.is_well_formed or M.shape != shape:
            return f"{name} does not have the size of the state"
    for channel in system.channels:
        if channel.bound <= 0 or len(channel.columns) != len(system.every_mode):
            return f"{channel.name} has no positive bound, or not one column for every mode"
    if not all(output.rows for output in system.outputs):
        return "an output has no rows"
    if any(output.limit is not None and output.limit <= 0 for output in system.outputs):
        return "the limit of an output is not positive"
    names = [*(c.name for c in system.channels), *(o.name for o in system.outputs)]
    return "two disturbances or outputs have one name" if len(set(names)) < len(names) else None


def _find_odd_rounding(system: SwitchedSystem) -> str | None:
    if system.roundings and system.time is Time.CONTINUOUS:
        return "the arithmetic rounds, but there are no steps"
    width = system.order + len(system.channels)
    widths = [width] * len(system.roundings)
    return _find_odd_errors(system, system.roundings, "the rounding of ", widths)


def _find_odd_clock(system: SwitchedSystem) -> str | None:
    if system.clock is None:
        return None
    if system.time is Time.CONTINUOUS or system.clock.length < 2 or not system.is_uniform:
        return "modes take turns without steps, in rounds of less than two, or of unlike size"
    if not system.switching.is_arbitrary:
        return "modes take turns, and have rules of switching besides"
    if (odd := _find_odd_automaton(system.clock)) is not None:
        return odd
    first = set(system.clock.first)
    groups = [{mode.name for mode in part} for part in (system.modes, system.free) if part]
    if not first <= set().union(*groups):
        return "a mode that does not exist is to take its turn"
    if not all(first & group and group - first for group in groups):
        return "a step of a round has no mode, in contact or free"
    return None


def _find_odd_automaton(clock: Clock) -> str | None:
    if clock.is_round:
        return None
    if len(clock.ahead) != clock.length or any(len(pair) != 2 for pair in clock.ahead):
        return "what may follow is not said of every state of an automaton"
    if any(not NOWHERE <= target < clock.length for pair in clock.ahead for target in pair):
        return "a step leads to a state that the automaton does not have"
    if any(set(pair) == {NOWHERE} for pair in clock.ahead):
        return "no mode may be in force in a state of an automaton"
    return None


def _find_odd_saturation(system: SwitchedSystem) -> str | None:
    if system.saturation is None:
        return None
    signals = system.saturation.signals
    if not 1 <= len(signals) <= MOST_SIGNALS:
        return f"no signal saturates, or more than {MOST_SIGNALS} do"
    widths = range(system.order, system.order + len(signals))
    if (odd := _find_odd_errors(system, signals, "", widths)) is not None:
        return odd
    for signal in signals:
        if signal.limit <= 0:
            return f"the limit of {signal.name} is not positive"
        rows, width = signal.errors, len(system.roundings)
        if rows and len(rows) != len(system.every_mode):
            return f"{signal.name} has not one row of what acts on it for every mode"
        if not all(row.is_well_formed and row.shape == (1, width) for row in rows):
            return f"{signal.name} does not know what the arithmetic rounds"
    return _find_odd_start(system, system.saturation.start)


def _find_odd_start(system: SwitchedSystem, start: Start) -> str | None:
    states = start.states
    if not states or not all(x.is_well_formed and x.shape == (system.order, 1) for x in states):
        return f"{start.name} does not have the size of the state"
    if not all(any(map(any, x.numerators)) for x in states):
        return f"{start.name} stands for a state that is zero"
    # Where contact is lost, V is not x'Qx.
    if system.free and any(x.numerators[-1][0] < 0 for x in states):
        return f"{start.name} stands for a state without contact"
    return None


def _find_odd_enclosure(system: SwitchedSystem) -> str | None:
    sizes = {mode.name: mode.A.shape for mode in system.every_mode}
    named = [name for names in system.enclosures for name in names]
    if not sizes.keys() >= set(named) or len(set(named)) < len(named):
        return "an enclosure is not one of modes, or a mode is in two of them"
    if any(len({sizes[name] for name in names}) != 1 for names in system.enclosures):
        return "an enclosure is empty, or its modes are not of one size"
    return None


def _find_odd_case(system: SwitchedSystem) -> str | None:
    if not system.cases:
        return None
    named = [name for names in system.cases for name in names]
    if sorted(named) != sorted(mode.name for mode in system.every_mode):
        return "a mode is in no case, or in two"
    if not system.switching.is_arbitrary or not system.is_uniform:
        return "there are cases, and rules of switching or modes of unlike size besides"
    cases = [frozenset(names) for names in system.cases]
    if any(not any(case.issuperset(names) for case in cases) for names in system.enclosures):
        return "what is between the modes of an enclosure is in no case"
    for only in map(system.only, system.cases):
        if not only.modes or bool(only.free) is not bool(system.free):
            return "a case has no mode, in contact or free"
        if (odd := _find_odd_clock(only)) is not None:
            return odd
    return None


def _find_odd_errors(
    system: SwitchedSystem,
    items: Sequence[Rounding | CutOff],
    said: str,
    widths: Iterable[int],
) -> str | None:
    """Say why columns and rows are not those of every mode and free mode, or None."""
    n = system.order
    if items and not system.is_uniform:
        return f"{said}{items[0].name} is of modes that are not of one size"
    for item, width in zip(items, widths, strict=True):
        sized = [*((M, (n, 1)) for M in item.columns), *((M, (1, width)) for M in item.rows)]
        if not all(M.is_well_formed and M.shape == shape for M, shape in sized):
            return f"{said}{item.name} does not have the size of the state"
        if not len(item.columns) == len(item.rows) == len(system.every_mode):
            return f"{said}{item.name} has not one column and row for every mode"
        if any(row.numerators[0][n - 1] for row in item.rows[len(system.modes) :]):
            return f"{said}{item.name} depends on the deflection in free motion"
    names = [item.name for item in items]
    return f"{said}{names[0]} is said twice" if len(set(names)) < len(names) else None


def _is_motion(A: RationalMatrix, order: int, time: Time) -> bool:
    """Tell whether a free mode has its shape, and the deflection only moves on from where it is."""
    if not A.is_well_formed or A.shape != (order, order):
        return False
    *others, last = (row[-1] for row in A.numerators)
    return not any(others) and last == (0 if time is Time.CONTINUOUS else A.denominator)
