"""Conditions on signals from the control section of a scenario."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product, starmap

from nrs_design.proof.bounds import lower_float, upper_float
from nrs_design.simulation.scenario import (
    COMMAND,
    DEPTH,
    TORQUE,
    Condition,
    Control,
    Surface,
    Switch,
)
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.scenarios import ControlSpec
from nrs_design.spec.threshold_logic import CommandCondition, TorqueCondition

# Signals below this magnitude have no sign, in rad/s and N m.
_TINY = 1e-9


def build_control(
    spec: InteractionDesignSpec, written: ControlSpec | None, surfaces: tuple[Surface, ...]
) -> Control:
    """Return who is in control when, by default what fits names and kinds of the controllers."""
    if written is None or written.logic is not None:
        return by_logic(spec) if spec.mode_logic is not None else _usual(spec)
    if written.fixed is not None:
        return Control(written.fixed)
    if written.schedule is not None:
        times = [(time.si, name) for time, name in written.schedule]
        return Control(times[0][1], schedule=tuple(times[1:]))
    if written.sign is not None:
        return _by_sign(written.sign.insertion, written.sign.withdrawal)
    if (given := written.threshold) is not None:
        return _by_threshold(given.position, given.force, given.torque.si)
    contact = written.contact or {}
    return Control(next(iter(contact.values())), tuple(_by_contact(contact, surfaces)))


def _usual(spec: InteractionDesignSpec) -> Control:
    """Return the control by names and kinds: signs, a torque threshold, or one controller."""
    controllers = spec.controllers.items()
    if {"insertion", "withdrawal"} <= spec.controllers.keys():
        return _by_sign("insertion", "withdrawal")
    position = next((n for n, c in controllers if c.holds_position), None)
    force = next((n for n, c in controllers if c.holds_force), None)
    if position and force:
        return _by_threshold(position, force, spec.limits.torque.si)
    return Control(next(iter(spec.controllers)))


_INWARD, _OUTWARD = Condition(COMMAND, low=_TINY), Condition(COMMAND, high=-_TINY)


def _by_sign(insertion: str, withdrawal: str) -> Control:
    """Return insertion and withdrawal by the signs of command and torque (thesis 6.3.2)."""
    switches = (
        Switch(insertion, withdrawal, (_OUTWARD, Condition(TORQUE, low=_TINY))),
        Switch(withdrawal, insertion, (_INWARD,)),
        Switch(withdrawal, insertion, (Condition(TORQUE, high=0.0),)),
    )
    return Control(insertion, switches)


def _by_threshold(position: str, force: str, torque: float) -> Control:
    """Return position control up to a torque in N m, force control beyond it (thesis 6.3.3)."""
    reached = (Condition(TORQUE, low=torque), _INWARD)
    switches = Switch(position, force, reached), Switch(force, position, (_OUTWARD,))
    return Control(position, switches)


def _by_contact(contacts: Mapping[str, str], surfaces: Sequence[Surface]) -> Iterator[Switch]:
    """Yield a switch into the controller of what is met; what is listed later comes first."""
    listed, named = list(contacts), [surface.environment for surface in surfaces]
    for place, (environment, target) in enumerate(contacts.items()):
        later = (i for i, name in enumerate(named) if name in listed[place + 1 :])
        left = tuple(Condition(f"{DEPTH}{i}", high=0.0) for i in later)
        for source, (i, name) in product(dict.fromkeys(contacts.values()), enumerate(named)):
            if source != target and name == environment:
                yield Switch(source, target, (Condition(f"{DEPTH}{i}", low=0.0), *left))


def by_logic(spec: InteractionDesignSpec) -> Control:
    """Return the thresholds and timers of the mode logic of a spec.

    Thresholds are rounded away from each other, and timers up: a proof for the spec covers them.
    """
    logic = spec.mode_logic
    assert logic is not None
    switches = tuple(
        Switch(one.source, one.target, tuple(starmap(_threshold, one.conditions.items())))
        for one in logic.switches
    )
    stays = {name: logic.stay(name) for name in logic.controllers}
    timers = {name: upper_float(stay.value) for name, stay in stays.items() if stay is not None}
    return Control(logic.start, switches, timers, ships=True)


def _threshold(signal: str, condition: CommandCondition | TorqueCondition) -> Condition:
    above, below = condition.above, condition.below
    low = -math.inf if above is None else upper_float(above.not_below)
    return Condition(signal, low, math.inf if below is None else lower_float(below.not_above))
