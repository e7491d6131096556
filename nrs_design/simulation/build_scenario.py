"""Scenarios of a spec in SI units, and the default scenario."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product, starmap

import numpy as np

from nrs_design.models.contact.law import AbstractNonlinearLaw, Element
from nrs_design.models.interval import Interval
from nrs_design.models.plant import Plant
from nrs_design.proof.bounds import lower_float, upper_float
from nrs_design.simulation.scenario import (
    COMMAND,
    DEPTH,
    TORQUE,
    Condition,
    Control,
    Errors,
    Profile,
    Scenario,
    Surface,
    Switch,
)
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.scenarios import CommandProfileSpec, ControlSpec, ErrorsSpec, ScenarioSpec
from nrs_design.spec.threshold_logic import CommandCondition, TorqueCondition

# Ends of an interval, as surfaces name them.
_ENDS = {"nominal": "nominal", "lowest": "low", "highest": "high"}
DEFAULT = "insertion-and-withdrawal"
# Thesis fig. 6.7 and 6.11: in free space to the largest command, down, again in contact, and out.
_SHAPE = ((0.0, 0.0), (1.0, 1.0), (2.0, 0.25), (3.0, 1.0), (4.0, 0.0), (5.0, -1.0), (6.0, -1.0),
          (7.0, 0.0), (7.5, 0.0))  # fmt: skip
# Time in s to the surface of the default scenario under the largest command.
_APPROACH = 1.0
# Signals below this magnitude have no sign, in rad/s and N m.
_TINY = 1e-9
_INWARD, _OUTWARD = Condition(COMMAND, low=_TINY), Condition(COMMAND, high=-_TINY)


def build_scenario(
    spec: InteractionDesignSpec, plant: Plant, name: str, scenario: ScenarioSpec
) -> Scenario:
    """Convert a scenario to SI."""
    target = spec.limits.torque if scenario.wanted_torque is None else scenario.wanted_torque
    surfaces = tuple(
        _surface(spec, plant, s.environment, s.at.si, 1 if s.side == "above" else -1, s.parameters)
        for s in scenario.surfaces
    )
    assert scenario.length is not None  # The spec states the length.
    return Scenario(
        name,
        _profile(scenario.command),
        scenario.length.si,
        surfaces,
        _control(spec, scenario.control, surfaces),
        0.0 if scenario.start is None else scenario.start.si,
        target.si,
        Errors() if scenario.errors is None else _errors(scenario.errors),
        scenario.seed,
        {} if scenario.limits is None else {n: q.si for n, q in scenario.limits.named.items()},
    )


def default_scenario(spec: InteractionDesignSpec, plant: Plant) -> Scenario:
    """Return a run into the first environment that is touched, and out again (thesis fig. 6.7)."""
    largest = spec.limits.velocity.si
    times, shares = np.array(_SHAPE).T
    environments = [name for name in spec.environments if name in spec.touched]
    surfaces = tuple(
        _surface(spec, plant, name, largest * _APPROACH, 1, "nominal") for name in environments[:1]
    )
    profile = Profile.through(times, shares * largest)
    control, target = _control(spec, None, surfaces), spec.limits.torque.si
    return Scenario(DEFAULT, profile, float(times[-1]), surfaces, control, wanted_torque=target)


def _profile(command: CommandProfileSpec) -> Profile:
    if command.constant is not None:
        return Profile.constant(command.constant.si)
    if (swing := command.sinusoid) is not None:
        mean = 0.0 if swing.offset is None else swing.offset.si
        return Profile.sinusoid(swing.amplitude.si, swing.frequency.si, mean)
    times, velocities = np.array([(t.si, v.si) for t, v in command.points or ()]).T
    return Profile.through(times, velocities)


def _surface(
    spec: InteractionDesignSpec, plant: Plant, name: str, angle: float, sign: int, end: str
) -> Surface:
    """Return an environment with every parameter at the same end of its range."""

    def pick(interval: Interval) -> float:
        return float(getattr(interval, _ENDS[end]))

    environment = plant.environment(name)
    law: Element | AbstractNonlinearLaw
    if environment.nonlinear is not None:
        law = environment.nonlinear.build(spec.environments[name].drawn_at_pivot(pick))
    else:
        law = environment.law(*map(pick, environment.ranges)).element
    return Surface(name, law, angle, sign)


def _errors(errors: ErrorsSpec) -> Errors:
    values = {name: value for name, value in errors if value is not None}
    jitter = float(values.pop("jitter", 0.0))
    return Errors(**{name: quantity.si for name, quantity in values.items()}, jitter=jitter)


def _control(
    spec: InteractionDesignSpec, control: ControlSpec | None, surfaces: tuple[Surface, ...]
) -> Control:
    """Return who is in control when, by default what fits names and kinds of the controllers."""
    if control is None or control.logic is not None:
        return logic_control(spec) if spec.mode_logic is not None else _default_control(spec)
    if control.fixed is not None:
        return Control(control.fixed)
    if control.schedule is not None:
        times = [(time.si, name) for time, name in control.schedule]
        return Control(times[0][1], schedule=tuple(times[1:]))
    if (sign := control.sign) is not None:
        return _sign_control(sign.insertion, sign.withdrawal)
    if (threshold := control.threshold) is not None:
        return _threshold_control(threshold.position, threshold.force, threshold.torque.si)
    contact = control.contact or {}
    return Control(next(iter(contact.values())), tuple(_contact_switches(contact, surfaces)))


def _default_control(spec: InteractionDesignSpec) -> Control:
    """Return the control by names and kinds: signs, a torque threshold, or one controller."""
    controllers = spec.controllers.items()
    if {"insertion", "withdrawal"} <= spec.controllers.keys():
        return _sign_control("insertion", "withdrawal")
    position = next((n for n, c in controllers if c.holds_position), None)
    force = next((n for n, c in controllers if c.holds_force), None)
    if position and force:
        return _threshold_control(position, force, spec.limits.torque.si)
    return Control(next(iter(spec.controllers)))


def _sign_control(insertion: str, withdrawal: str) -> Control:
    """Return insertion and withdrawal by the signs of command and torque (thesis 6.3.2)."""
    switches = (
        Switch(insertion, withdrawal, (_OUTWARD, Condition(TORQUE, low=_TINY))),
        Switch(withdrawal, insertion, (_INWARD,)),
        Switch(withdrawal, insertion, (Condition(TORQUE, high=0.0),)),
    )
    return Control(insertion, switches)


def _threshold_control(position: str, force: str, torque: float) -> Control:
    """Return position control up to a torque in N m, force control beyond it (thesis 6.3.3)."""
    into_force = Switch(position, force, (Condition(TORQUE, low=torque), _INWARD))
    return Control(position, (into_force, Switch(force, position, (_OUTWARD,))))


def _contact_switches(contacts: Mapping[str, str], surfaces: Sequence[Surface]) -> Iterator[Switch]:
    """Yield a switch into the controller of what is met; what is listed later comes first."""
    names = list(contacts)
    for place, (environment, target) in enumerate(contacts.items()):
        later = (i for i, s in enumerate(surfaces) if s.environment in names[place + 1 :])
        no_contact = tuple(Condition(f"{DEPTH}{i}", high=0.0) for i in later)
        for source, (i, surface) in product(dict.fromkeys(contacts.values()), enumerate(surfaces)):
            if source != target and surface.environment == environment:
                yield Switch(source, target, (Condition(f"{DEPTH}{i}", low=0.0), *no_contact))


def logic_control(spec: InteractionDesignSpec) -> Control:
    """Return the thresholds and timers of the mode logic of a spec.

    Thresholds are rounded away from each other, and timers up: a proof for the spec covers them.
    """
    logic = spec.mode_logic
    assert logic is not None
    switches = tuple(
        Switch(one.source, one.target, tuple(starmap(_threshold, one.conditions.items())))
        for one in logic.switches
    )
    dwells = {name: logic.stay(name) for name in logic.controllers}
    timers = {name: upper_float(time.value) for name, time in dwells.items() if time is not None}
    return Control(logic.start, switches, timers, ships=True)


def _threshold(signal: str, condition: CommandCondition | TorqueCondition) -> Condition:
    lowest, highest = condition.above, condition.below
    low = -math.inf if lowest is None else upper_float(lowest.not_below)
    return Condition(signal, low, math.inf if highest is None else lower_float(highest.not_above))
