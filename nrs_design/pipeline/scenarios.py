"""From a design to runs of its scenarios, and what is certified beside them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nrs_design.certificates.certificate import Certificate
from nrs_design.errors import CertificateError, DesignError
from nrs_design.pipeline.design import Designed, Progress, placed, silent
from nrs_design.proof.noun import dataclass

if TYPE_CHECKING:
    from nrs_design.simulation.run import Run
    from nrs_design.simulation.scenario import Scenario
    from nrs_design.spec import InteractionDesignSpec
    from nrs_design.spec.sampling import SamplingSpec


@dataclass(frozen=True, slots=True)
class Simulated:
    """A scenario that has been simulated.

    Parameters
    ----------
    scenario : Scenario
        In SI.
    run : Run
        As far as it came.
    metrics : mapping
        Of the run, in SI.
    """

    scenario: Scenario
    run: Run
    metrics: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class CertifiedBound:
    """A certified bound beside a run.

    Parameters
    ----------
    output, unit : str
        What is bounded.
    level : float
        Not below what is proved.
    uncovered : tuple of str
        What happens in the run that the proof says nothing about; empty if the bound holds for it.
    """

    output: str
    unit: str
    level: float
    uncovered: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Runs:
    """How scenarios are run; None leaves what the spec says.

    Parameters
    ----------
    names : tuple of str
        Which; empty for all.
    engine : {"exact", "sampled"} or None
        By default sampled where the spec has sampling or tissue is not linear, else exact.
    period : float or None
        Of the sampled engine, in s; 2 ms where nothing says it.
    delay : int or None
        Age of its force samples, in samples; none where nothing says it.
    max_steps : int or None
        Of each run.
    """

    names: tuple[str, ...] = ()
    engine: str | None = None
    period: float | None = None
    delay: int | None = None
    max_steps: int | None = None


def run_scenarios(
    designed: Designed, wanted: Runs | None = None, progress: Progress = silent
) -> Iterator[Simulated]:
    """Simulate scenarios of a spec; a spec without any has one of its own.

    Parameters
    ----------
    designed : Designed
        The spec, its plant and its gains.
    wanted : Runs, optional
        Which, and how.
    progress : callable
        Told the name of each run, and how far it is.

    Yields
    ------
    Simulated
        One run after the other.

    Raises
    ------
    DesignError, DataError
        If there is no such scenario, or it cannot be simulated.
    """
    wanted = wanted or Runs()
    with placed(designed.loaded):
        for scenario in scenarios_of(designed, wanted.names):
            yield simulate_one(designed, scenario, wanted, progress)


def simulate_one(
    designed: Designed, scenario: Scenario, wanted: Runs, progress: Progress = silent
) -> Simulated:
    """Simulate one scenario with the engine that is wanted, and measure the run.

    Parameters
    ----------
    designed : Designed
        The spec, its plant and its gains.
    scenario : Scenario
        In SI.
    wanted : Runs
        How.
    progress : callable
        Told how far the run is.

    Raises
    ------
    DesignError
        If it cannot be simulated.
    """
    from nrs_design.simulation.exact import simulate_exactly
    from nrs_design.simulation.run import MAX_STEPS
    from nrs_design.simulation.sampled import simulate_sampled
    from nrs_design.simulation.summary import summarize

    spec = designed.spec
    # A law of tissue that is not linear has no exponential.
    nonlinear = any(surface.element is None for surface in scenario.surfaces)
    usual = "sampled" if spec.sampling is not None or nonlinear else "exact"
    sampled = (wanted.engine or usual) == "sampled"
    timed = spec.model_copy(update={"sampling": _sampling(spec, wanted)}) if sampled else spec
    run = (simulate_sampled if sampled else simulate_exactly)(
        timed,
        designed.plant,
        designed.design,
        scenario,
        max_steps=wanted.max_steps or MAX_STEPS,
        tell=partial(_tell, progress, scenario.name),
    )
    return Simulated(scenario, run, summarize(spec, scenario, run))


def _sampling(spec: InteractionDesignSpec, wanted: Runs) -> SamplingSpec:
    """Return the sampling of a spec, changed as is wanted."""
    from nrs_design.spec.sampling import SamplingSpec

    usual = SamplingSpec.model_validate({"period": "2 ms", "delay": "0"})
    changes: dict[str, object] = {}
    if wanted.period is not None:
        text = {"period": f"{wanted.period!r} s", "delay": "0"}
        changes["period"] = SamplingSpec.model_validate(text).period
    if wanted.delay is not None:
        changes["delay"] = (wanted.delay, wanted.delay)
    return (spec.sampling or usual).model_copy(update=changes)


def _tell(progress: Progress, name: str, step: str) -> None:
    progress(f"{name}, {step}")


def scenarios_of(designed: Designed, names: Sequence[str]) -> list[Scenario]:
    """Return scenarios of a spec in SI; a spec without any has one of its own.

    Parameters
    ----------
    designed : Designed
        The spec and its plant.
    names : sequence of str
        Which; empty for all.

    Raises
    ------
    DesignError, DataError
        If there is no such scenario, or its file of commands cannot be read.
    """
    from nrs_design.simulation.build_scenario import build_scenario, default_scenario
    from nrs_design.spec.faults import did_you_mean

    spec, plant, path = designed.spec, designed.plant, designed.loaded.path
    if not spec.scenarios:
        own = default_scenario(spec, plant)
        if set(names) <= {own.name}:
            return [own]
    for name in names:
        if name not in spec.scenarios:
            remedy = did_you_mean(name, spec.scenarios) if spec.scenarios else "add scenarios"
            raise DesignError(f"the spec has no scenario {name!r}", remedy=remedy)
    folder = Path() if path is None else path.parent
    return [
        build_scenario(spec, plant, name, spec.scenarios[name], folder)
        for name in names or spec.scenarios
    ]


def hold_bounds(
    designed: Designed, certificate: Certificate, simulated: Simulated
) -> tuple[CertifiedBound, ...]:
    """Hold what is certified against a run.

    Parameters
    ----------
    designed : Designed
        The spec and its plant.
    certificate : Certificate
        Checked, of that spec.
    simulated : Simulated
        A run of that spec.
    """
    from nrs_design.proof.bounds import upper_float
    from nrs_design.simulation.coverage import uncovered

    system, found = certificate.system, []
    for statement in certificate.statements:
        bound = statement.bound(system)
        # One bound for each output is about all disturbances at once.
        if bound is None or set(bound.channels) != set(system.channels):
            continue
        reasons = uncovered(designed.spec, system, statement, simulated.scenario, simulated.run)
        level = upper_float(bound.level)
        found.append(CertifiedBound(bound.output.name, bound.output.unit, level, tuple(reasons)))
    return tuple(found)


def read_certificate(file: Path, designed: Designed) -> Certificate:
    """Return what a certificate file holds, checked exactly against the spec.

    Raises
    ------
    CertificateError
        If it is none, or does not hold for this spec.
    """
    from nrs_design.certificates.verify import verify

    found = verify(file, designed.loaded, plant=designed.plant)
    if found.certificate is None or found.fault is not None:
        raise CertificateError(
            str(found.fault), path=file, remedy="make it anew with certify-switching"
        )
    return found.certificate
