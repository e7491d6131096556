"""``nrs-design simulate``: run the scenarios of a spec, and measure what happens."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import typer

from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import progress
from nrs_design.cli.simulate_options import (
    Bound,
    BoundsOf,
    Delay,
    Engine,
    EngineOption,
    MaxSteps,
    Out,
    OuterPeriod,
    Period,
    Scenarios,
    WorstCaseFlag,
)
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline.design import Designed


@command("simulate")
def simulate(
    spec: SpecFile,
    scenario: Scenarios = None,
    engine: Engine = None,
    out: Out = None,
    certificate: BoundsOf = None,
    bound: Bound = True,
    period: Period = None,
    delay: Delay = None,
    outer_period: OuterPeriod = None,
    max_steps: MaxSteps = None,
    worst: WorstCaseFlag = False,
) -> Answer:
    """Simulate the interaction of robot, tissue and surgeon, and measure safety and agility.

    Scenarios are in the spec; without any, the command of thesis fig. 6.7 moves into the first
    environment and out again. A run proves nothing: it shows one thing that may happen.

    Example: nrs-design simulate docs/examples/scenarios.nrs.yaml --out runs

    Example: nrs-design simulate docs/examples/scenarios.nrs.yaml --worst-case
    """
    from nrs_design.cli.simulate_scenarios import simulate_scenarios
    from nrs_design.cli.worst_case import worst_case
    from nrs_design.pipeline.runs import run_interaction_of
    from nrs_design.pipeline.scenarios import Runs

    timed = any(value is not None for value in (period, delay, outer_period))
    if engine is EngineOption.EXACT and timed:
        raise typer.BadParameter("the exact engine has no samples", param_hint="--engine")
    if worst and any((scenario, engine, period, delay is not None, outer_period, max_steps)):
        message = "the adversary plays against the loop of the spec, not within a scenario"
        raise typer.BadParameter(message, param_hint="--worst-case")
    loaded = take_spec(spec)
    if engine is None and timed:
        engine = EngineOption.SAMPLED
    how = None if engine is None else str(engine)
    wanted = Runs(tuple(dict.fromkeys(scenario or ())), how, period, delay, max_steps, outer_period)
    with progress(f"simulating {loaded.spec.name}") as step:
        designed, kept = run_interaction_of(loaded, certificate, "describes no interaction", step)
        prove = partial(_proof, designed, kept, step, bound=bound)
        if worst:
            return worst_case(designed, prove(), out, step)
        return simulate_scenarios(designed, wanted, prove, out, step)


def _proof(
    designed: Designed, kept: Certificate | None, step: Progress, *, bound: bool
) -> Certificate | None:
    """Return the certificate whose bounds are shown, if there is one."""
    if kept is not None or not bound or designed.spec.disturbances is None:
        return kept
    from nrs_design.pipeline.certification import certify_design

    step("certifying its bounds")
    return certify_design(designed.loaded, designed, progress=step).certificate
