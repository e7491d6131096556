"""Scenarios run again and again, with parameters drawn from the ranges of their spec."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from nrs_design.controllers.controller_design import Controller, ControllerDesign
from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.gain_range import gain_interval
from nrs_design.models.actuator import Actuator
from nrs_design.models.plant import Plant
from nrs_design.simulation.build_scenario import Pick, drawn_laws
from nrs_design.simulation.peaks import PEAKS
from nrs_design.simulation.scenario import Scenario
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.interval import Interval
from nrs_design.spec.scenarios import LARGEST_SEED

CONFIDENCE = 0.95


@dataclass(frozen=True, slots=True)
class Drawn:
    """One run that is to be simulated."""

    scenario: Scenario  # With laws of tissue and a seed of its own
    plant: Plant  # With a motor of its own
    design: ControllerDesign  # With gains of its own
    parameters: Mapping[str, float]  # What was drawn, in SI


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one run came to."""

    index: int  # Of the run, from zero
    scenario: str  # Its name
    seed: int  # Of noise, jitter and varying delay
    peaks: Mapping[str, float]  # By the names of `PEAKS`, in SI
    stopped: str | None  # Why the run ended before its time
    parameters: Mapping[str, float]  # What was drawn
    # What happened in it that no proof takes up, and may not happen at other parameters.
    uncovered: Sequence[str]

    @classmethod
    def of(
        cls,
        index: int,
        drawn: Drawn,
        metrics: Mapping[str, Any],
        stopped: str | None,
        uncovered: Sequence[str],
    ) -> Outcome:
        """Return what a run came to, from its metrics.

        Parameters
        ----------
        index : int
            Of the run.
        drawn : Drawn
            What was simulated.
        metrics : mapping
            As `nrs_design.simulation.summary` names them.
        stopped : str or None
            Why the run ended before its time.
        uncovered : sequence of str
            As for the class.
        """
        peaks = {name: float(metrics[key]) for name, key in PEAKS.items()}
        seed = drawn.scenario.seed
        name = drawn.scenario.name
        return cls(index, name, seed, peaks, stopped, drawn.parameters, uncovered)

    def exceeds(self, quantity: str, limit: float) -> bool:
        """Tell whether a peak is above a limit; a run that was stopped counts as above it."""
        return self.stopped is not None or self.peaks[quantity] > limit


@dataclass(frozen=True, slots=True)
class Share:
    """How many runs were above a limit."""

    # above, runs: how many of how many.
    above: int
    runs: int
    # Ends of the exact interval of Clopper and Pearson (1934) for the probability of it, with the
    # confidence `CONFIDENCE`.
    low: float
    high: float

    @classmethod
    def of(cls, above: int, runs: int) -> Share:
        """Return the share with its interval.

        Parameters
        ----------
        above, runs : int
            How many of how many; at least one run.
        """
        from scipy.stats import binomtest

        interval = binomtest(above, runs).proportion_ci(CONFIDENCE, method="exact")
        return cls(above, runs, float(interval.low), float(interval.high))

    @property
    def value(self) -> float:
        """The share itself."""
        return self.above / self.runs


def draw(
    spec: InteractionDesignSpec,
    plant: Plant,
    design: ControllerDesign,
    scenarios: Sequence[Scenario],
    seed: int,
    index: int,
) -> Drawn:
    """Draw a run; it depends on seed and index alone, not on the runs before it.

    Scenarios take turns. Every parameter of what is touched and of the motor, and every gain, is
    drawn uniformly from its range, each for itself; what has no range stays as it is.

    Parameters
    ----------
    spec : InteractionDesignSpec
        With the ranges.
    plant : Plant
        Of that spec.
    design : ControllerDesign
        The gains that ship.
    scenarios : sequence of Scenario
        At least one.
    seed : int
        Of all runs.
    index : int
        Of this one.
    """
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(index,)))
    scenario = scenarios[index % len(scenarios)]
    parameters: dict[str, float] = {}

    def pick(interval: Interval) -> float:
        return float(rng.uniform(float(interval.low), float(interval.high)))

    each = (name for s in scenario.surfaces for name in (s.environment, *s.beside))
    names = list(dict.fromkeys(each))
    laws = drawn_laws(spec, plant, names, pick)
    for name, (law, _) in laws.items():
        parameters |= {f"{name} {key}": value for key, value in _numbers(law)}
    ranges = plant.actuator_ranges
    if ranges is not None:
        gain, tau = pick(ranges.gain), pick(ranges.time_constant)
        parameters |= {"motor gain": gain, "motor time constant": tau}
        motor = Actuator(Fraction(gain), Fraction(tau), plant.actuator.command)
        plant = replace(plant, actuator=motor)
    surfaces = tuple(surface.with_laws(laws) for surface in scenario.surfaces)
    own = int(rng.integers(0, LARGEST_SEED + 1))
    controllers = tuple(_retuned(spec, one, pick, parameters) for one in design.controllers)
    drawn = replace(scenario, surfaces=surfaces, seed=own)
    return Drawn(drawn, plant, replace(design, controllers=controllers), parameters)


def _retuned(
    spec: InteractionDesignSpec, controller: Controller, pick: Pick, parameters: dict[str, float]
) -> Controller:
    """Draw the gains that have a range, in single precision, as they would ship."""
    law, gains = controller.law, dict(controller.law.gains)
    for gain, declared in spec.controllers[controller.name].gains().items():
        if declared.ranged:
            gains[gain] = to_float32(Fraction(pick(gain_interval(declared, gains[gain]))))
            parameters[f"{controller.name} {gain}"] = float(gains[gain])
    return replace(controller, law=law.of(gains))


def _numbers(law: object) -> Iterable[tuple[str, float]]:
    from dataclasses import fields, is_dataclass

    if is_dataclass(law):
        for field in fields(law):
            value = getattr(law, field.name)
            if isinstance(value, int | float):
                yield field.name, float(value)


def shares(
    outcomes: Sequence[Outcome], limits: Mapping[str, Mapping[str, float]]
) -> dict[str, Share]:
    """Return for every quantity that has a limit how many runs were above it.

    Parameters
    ----------
    outcomes : sequence of Outcome
        Of all runs.
    limits : mapping of str to mapping of str to float
        For each scenario, the limits of quantities.
    """
    found = {}
    for quantity in PEAKS:
        bounded = [one for one in outcomes if quantity in limits[one.scenario]]
        if bounded:
            above = sum(one.exceeds(quantity, limits[one.scenario][quantity]) for one in bounded)
            found[quantity] = Share.of(above, len(bounded))
    return found


def held_against(
    bound: tuple[float, tuple[str, ...]], outcomes: Sequence[Outcome]
) -> tuple[float, tuple[str, ...]]:
    """Return a certified bound with every reason for which it is not about the runs.

    Parameters
    ----------
    bound : tuple of (float, tuple of str)
        What is certified, and why it is not about the scenarios as they are written.
    outcomes : sequence of Outcome
        Of all runs.
    """
    level, reasons = bound
    drawn = (reason for one in outcomes for reason in one.uncovered)
    return level, tuple(dict.fromkeys((*reasons, *drawn)))
