"""A scenario with parameters drawn from the ranges of its spec."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from nrs_design.controllers.controller_design import ControllerDesign
from nrs_design.models.actuator import Actuator
from nrs_design.models.interval import Interval
from nrs_design.models.plant import Plant
from nrs_design.simulation.build_scenario import drawn_laws
from nrs_design.simulation.scenario import Scenario
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.scenarios import LARGEST_SEED


@dataclass(frozen=True, slots=True)
class Drawn:
    """A run that is to be simulated, with drawn tissue, motor and seed."""

    scenario: Scenario
    plant: Plant
    design: ControllerDesign
    # What was drawn, in SI.
    parameters: Mapping[str, float]


def draw(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenario: Scenario,
    seed: int,
) -> Drawn:
    """Draw every parameter of tissue and motor, and the seed of the noise.

    Each is uniform in its range, independent of the others, and stays for the run; what has no
    range stays as it is.
    """
    rng = np.random.default_rng(seed)
    parameters: dict[str, float] = {}

    def pick(interval: Interval) -> float:
        return float(rng.uniform(float(interval.low), float(interval.high)))

    each = (name for s in scenario.surfaces for name in (s.environment, *s.beside))
    laws = drawn_laws(spec, plant, list(dict.fromkeys(each)), pick)
    for name, (law, _) in laws.items():
        parameters |= {f"{name} {key}": value for key, value in _numbers(law)}
    ranges = plant.actuator_ranges
    if not ranges.fixed:
        gain, tau = pick(ranges.gain), pick(ranges.time_constant)
        parameters |= {"motor gain": gain, "motor time constant": tau}
        motor = Actuator(Fraction(gain), Fraction(tau), plant.actuator.command)
        plant = replace(plant, actuator=motor)
    surfaces = tuple(surface.with_laws(laws) for surface in scenario.surfaces)
    own = int(rng.integers(0, LARGEST_SEED + 1))
    scenario = replace(scenario, surfaces=surfaces, seed=own)
    return Drawn(scenario, plant, design, parameters)


def _numbers(law: object) -> Iterable[tuple[str, float]]:
    from dataclasses import fields, is_dataclass

    if is_dataclass(law):
        for field in fields(law):
            value = getattr(law, field.name)
            if isinstance(value, int | float):
                yield field.name, float(value)
