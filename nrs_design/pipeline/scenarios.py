"""From a design to runs of its scenarios."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import Designed, placed
from nrs_design.progress import Progress, silent
from nrs_design.wings import load_wing

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
        for name, group in scenarios_of(designed, wanted):
            yield from _simulate(designed, name, group, wanted, progress)


def _simulate(
    designed: Designed,
    name: str,
    group: Sequence[Scenario],
    wanted: Runs,
    progress: Progress = silent,
) -> Iterator[Simulated]:
    """Simulate what one axis does, or three of a robot at once, and measure the runs."""
    from nrs_design.simulation.bodies import simulate_on_body
    from nrs_design.simulation.exact import simulate_exactly
    from nrs_design.simulation.run import MAX_STEPS
    from nrs_design.simulation.summary import summarize

    spec, engine = designed.spec, wanted.engine or _usual(designed.spec, group)
    given = designed.plant, designed.design
    most, tell = wanted.max_steps or MAX_STEPS, partial(_tell, progress, name)
    if engine == "exact":
        runs = tuple(
            simulate_exactly(spec, *given, one, max_steps=most, tell=tell) for one in group
        )
    else:
        timed = spec.model_copy(update={"sampling": _sampling(spec, wanted)})
        arm = _arm(designed, name) if len(group) > 1 else None
        runs = simulate_on_body(timed, *given, group, engine, arm, max_steps=most, tell=tell)
    for scenario, run in zip(group, runs, strict=True):
        yield Simulated(scenario, run, summarize(spec, scenario, run))


def folder_of(designed: Designed) -> Path:
    """Return the folder of a spec, for files that it names."""
    path = designed.loaded.path
    return Path() if path is None else path.parent


def _usual(spec: InteractionDesignSpec, group: Sequence[Scenario]) -> str:
    """Return the engine for a scenario: a law of tissue that is not linear has no exponential."""
    nonlinear = any(not surface.is_linear for one in group for surface in one.surfaces)
    sampled = spec.sampling is not None or nonlinear or len(group) > 1
    return "sampled" if sampled else "exact"


def _arm(designed: Designed, name: str) -> object:
    """Return the robot of a spec in the pose in which a scenario of three axes begins."""
    spec = designed.spec
    assert spec.coupling is not None
    assert spec.coupling.robot is not None
    axes = spec.scenarios[name].axes if name in spec.scenarios else None
    pose = None if axes is None else axes.pose
    rest = None if pose is None else (pose.phi.si, pose.psi.si, pose.d.si)
    holds = spec.coupling.gravity_compensated == "at-rest"
    path = folder_of(designed) / spec.coupling.robot
    arm: object = load_wing("robot", "pipeline").build_arm(path, rest, holds)
    return arm


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


def _tell(progress: Progress, name: str, step: str) -> None:
    progress(f"{name}, {step}")


def scenarios_of(designed: Designed, wanted: Runs) -> list[tuple[str, tuple[Scenario, ...]]]:
    """Return the scenarios that are wanted, in SI: of each its name, and one for each axis."""
    from nrs_design.simulation.build_scenario import build_runs

    spec, folder = designed.spec, folder_of(designed)
    return [(name, build_runs(spec, designed.plant, name, folder)) for name in _names(spec, wanted)]


def _names(spec: InteractionDesignSpec, wanted: Runs) -> Sequence[str]:
    """Return the scenarios that are run; what three axes do has no exact engine."""
    from nrs_design.simulation.build_scenario import default_names, run_names
    from nrs_design.spec.faults import did_you_mean

    known = tuple(spec.scenarios) or default_names(spec)
    for name in wanted.names:
        if name not in known:
            remedy = did_you_mean(name, known)
            raise DesignError(f"the spec has no scenario {name!r}", remedy=remedy)
    if wanted.engine == "exact" and not wanted.names and not spec.scenarios:
        return known[:1]
    for name in wanted.names or known:
        if wanted.engine == "exact" and len(run_names(spec, (name,))) > 1:
            raise DesignError(
                f"{name} moves three axes of a robot, whose dynamics is not linear",
                remedy="use --engine sampled or mujoco",
                at=("scenarios", name, "axes"),
            )
    return wanted.names or known
