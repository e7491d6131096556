"""Scenarios of a spec in SI units, and the default scenario."""

from __future__ import annotations

import numpy as np

from nrs_design.models.contact.law import AbstractNonlinearLaw, Element
from nrs_design.models.interval import Interval
from nrs_design.models.plant import Plant
from nrs_design.simulation.build_control import build_control
from nrs_design.simulation.scenario import Errors, Profile, Scenario, Surface
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.scenarios import (
    CommandProfileSpec,
    ErrorsSpec,
    ScenarioSpec,
)

# Ends of an interval, as surfaces name them.
_ENDS = {"nominal": "nominal", "lowest": "low", "highest": "high"}
DEFAULT = "insertion-and-withdrawal"
# Thesis fig. 6.7 and 6.11: in free space to the largest command, down, again in contact, and out.
_SHAPE = ((0.0, 0.0), (1.0, 1.0), (2.0, 0.25), (3.0, 1.0), (4.0, 0.0), (5.0, -1.0), (6.0, -1.0),
          (7.0, 0.0), (7.5, 0.0))  # fmt: skip
# Time in s to the surface of the default scenario under the largest command.
_AWAY = 1.0


def build_scenario(
    spec: InteractionDesignSpec, plant: Plant, name: str, scenario: ScenarioSpec
) -> Scenario:
    """Convert a scenario to SI."""
    wanted = spec.limits.torque if scenario.wanted_torque is None else scenario.wanted_torque
    surfaces = tuple(
        _surface(spec, plant, s.environment, s.at.si, 1 if s.side == "above" else -1, s.parameters)
        for s in scenario.surfaces
    )
    assert scenario.length is not None  # the spec says it
    return Scenario(
        name,
        _profile(scenario.command),
        scenario.length.si,
        surfaces,
        build_control(spec, scenario.control, surfaces),
        0.0 if scenario.start is None else scenario.start.si,
        wanted.si,
        Errors() if scenario.errors is None else _errors(scenario.errors),
        scenario.seed,
        {} if scenario.limits is None else {n: q.si for n, q in scenario.limits.named.items()},
    )


def default_scenario(spec: InteractionDesignSpec, plant: Plant) -> Scenario:
    """Return a run into the first environment that is touched, and out again (thesis fig. 6.7)."""
    largest = spec.limits.velocity.si
    times, shares = np.array(_SHAPE).T
    touched = [name for name in spec.environments if name in spec.touched]
    at = largest * _AWAY
    surfaces = tuple(_surface(spec, plant, name, at, 1, "nominal") for name in touched[:1])
    profile = Profile.through(times, shares * largest)
    control, wanted = build_control(spec, None, surfaces), spec.limits.torque.si
    return Scenario(DEFAULT, profile, float(times[-1]), surfaces, control, wanted_torque=wanted)


def _profile(command: CommandProfileSpec) -> Profile:
    if command.constant is not None:
        return Profile.constant(command.constant.si)
    if (swing := command.sinusoid) is not None:
        mean = 0.0 if swing.offset is None else swing.offset.si
        return Profile.sinusoid(swing.amplitude.si, swing.frequency.si, mean)
    times, velocities = np.array([(t.si, v.si) for t, v in command.points or ()]).T
    return Profile.through(times, velocities)


def _surface(
    spec: InteractionDesignSpec, plant: Plant, name: str, at: float, sign: int, end: str
) -> Surface:
    """Return an environment with every parameter at the same end of its range."""

    def pick(interval: Interval) -> float:
        return float(getattr(interval, _ENDS[end]))

    environment = plant.environment(name)
    law: Element | AbstractNonlinearLaw
    if environment.nonlinear is not None:
        law = environment.nonlinear.drawn(spec.environments[name].drawn_at_pivot(pick))
    else:
        law = environment.law(*map(pick, environment.ranges)).element
    return Surface(name, law, at, sign)


def _errors(written: ErrorsSpec) -> Errors:
    given = {name: value for name, value in written if value is not None}
    jitter = float(given.pop("jitter", 0.0))
    return Errors(**{name: quantity.si for name, quantity in given.items()}, jitter=jitter)
