"""From a design to runs of its scenarios."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import Designed, placed
from nrs_design.progress import Progress, silent

if TYPE_CHECKING:
    from nrs_design.simulation.run import Run
    from nrs_design.simulation.scenario import Scenario
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.sampling import SamplingSpec


@dataclass(frozen=True, slots=True)
class Simulated:
    """A scenario that has been simulated."""

    scenario: Scenario  # In SI
    run: Run  # As far as it came
    metrics: Mapping[str, Any]  # Of the run, in SI


@dataclass(frozen=True, slots=True)
class Runs:
    """How scenarios are run; None leaves what the spec says."""

    names: tuple[str, ...] = ()  # Which; empty for all
    # By default sampled where the spec has sampling or tissue is not linear, else exact.
    engine: str | None = None
    period: float | None = None  # Of the sampled engine, in s; 2 ms where nothing says it
    delay: int | None = None  # Age of its force samples, in samples; none where nothing says it
    max_steps: int | None = None  # Of each run
    # Of force, filter and admittance, in s; that of the motion loop where nothing says it.
    outer_period: float | None = None


def run_scenarios(
    designed: Designed, wanted: Runs | None = None, progress: Progress = silent
) -> Iterator[Simulated]:
    """Simulate scenarios of a spec one after the other; a spec without any has one of its own."""
    wanted = wanted or Runs()
    with placed(designed.loaded):
        for scenario in scenarios_of(designed, wanted):
            yield _simulate(designed, scenario, wanted, progress)


def _simulate(
    designed: Designed, scenario: Scenario, wanted: Runs, progress: Progress
) -> Simulated:
    """Simulate a scenario, and measure the run."""
    from nrs_design.simulation.exact import simulate_exactly
    from nrs_design.simulation.run import MAX_STEPS
    from nrs_design.simulation.sampled import simulate_sampled
    from nrs_design.simulation.summary import summarize

    spec, engine = designed.spec, wanted.engine or _usual(designed.spec, scenario)
    given, most = (designed.plant, designed.design, scenario), wanted.max_steps or MAX_STEPS

    def tell(step: str) -> None:
        progress(f"{scenario.name}, {step}")

    if engine == "exact":
        run = simulate_exactly(spec, *given, max_steps=most, tell=tell)
    else:
        timed = spec.model_copy(update={"sampling": _sampling(spec, wanted)})
        run = simulate_sampled(timed, *given, max_steps=most, tell=tell)
    return Simulated(scenario, run, summarize(spec, scenario, run))


def _usual(spec: InteractionDesignSpec, scenario: Scenario) -> str:
    """Return the engine for a scenario: a law of tissue that is not linear has no exponential."""
    nonlinear = any(not surface.is_linear for surface in scenario.surfaces)
    return "sampled" if spec.sampling is not None or nonlinear else "exact"


def _sampling(spec: InteractionDesignSpec, wanted: Runs) -> SamplingSpec:
    """Return the sampling of a spec, changed as is wanted."""
    from nrs_design.spec.sampling import SamplingSpec

    usual = SamplingSpec.model_validate({"period": "2 ms", "delay": "0"})
    changes: dict[str, object] = {}
    for key, value in (("period", wanted.period), ("outer_period", wanted.outer_period)):
        if value is not None:
            text = {"period": f"{value!r} s", "delay": "0"}
            changes[key] = SamplingSpec.model_validate(text).period
    if wanted.delay is not None:
        changes["delay"] = (wanted.delay, wanted.delay)
    return (spec.sampling or usual).model_copy(update=changes)


def scenarios_of(designed: Designed, wanted: Runs) -> list[Scenario]:
    """Return the scenarios that are wanted, in SI."""
    from nrs_design.simulation.build_scenario import build_scenario, default_scenario

    spec, plant, path = designed.spec, designed.plant, designed.loaded.path
    folder = Path() if path is None else path.parent
    return [
        build_scenario(spec, plant, name, spec.scenarios[name], folder)
        if spec.scenarios
        else default_scenario(spec, plant)
        for name in names_of(spec, wanted)
    ]


def names_of(spec: InteractionDesignSpec, wanted: Runs) -> Sequence[str]:
    """Return the names of the scenarios that are wanted; a spec without any has one of its own."""
    from nrs_design.simulation.build_scenario import DEFAULT
    from nrs_design.spec.faults import did_you_mean

    known = tuple(spec.scenarios) or (DEFAULT,)
    for name in wanted.names:
        if name not in known:
            remedy = did_you_mean(name, known)
            raise DesignError(f"the spec has no scenario {name!r}", remedy=remedy)
    return wanted.names or known
