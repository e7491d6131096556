"""``nrs-design simulate``: run the scenarios of a spec, and measure what happens."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.options import SpecFile, seconds
from nrs_design.cli.printing import progress
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline.design import Designed


@command("simulate")
def simulate(
    spec: SpecFile,
    scenario: Annotated[
        list[str] | None,
        typer.Option("--scenario", metavar="NAME", help="One scenario, or several; default: all."),
    ] = None,
    engine: Annotated[
        Literal["exact", "sampled"] | None,
        typer.Option(
            help="exact: continuous time, from event to event; sampled: the law that ships, in "
            "single precision. Default: sampled where the spec has sampling or tissue is not "
            "linear."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER", help="Write SPEC.SCENARIO.svg, .png and .csv of every run there."
        ),
    ] = None,
    certificate: Annotated[
        Path | None,
        typer.Option(metavar="CERT", help="Show the bounds of this certificate of the spec."),
    ] = None,
    bound: Annotated[
        bool, typer.Option(help="Certify a bound where the spec says what disturbs the loop.")
    ] = True,
    period: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            parser=seconds(1e-5, 1.0),
            help="Period of the sampled engine in s, not the spec's; without either, 0.002.",
        ),
    ] = None,
    delay: Annotated[
        int | None,
        typer.Option(min=0, max=10, help="Age of its force samples in samples, not the spec's."),
    ] = None,
    outer_period: Annotated[
        float | None,
        typer.Option(
            metavar="S",
            min=1e-5,
            max=1.0,
            help="Period of its force samples and admittances in s, not that of the motion loop.",
        ),
    ] = None,
    max_steps: Annotated[
        int | None, typer.Option(min=1, help="Most steps of a run; beyond, exit code 3.")
    ] = None,
    worst: Annotated[
        bool,
        typer.Option(
            "--worst-case",
            help="Let an adversary choose controllers, contact, delay and disturbances, and show "
            "the worst runs that he finds.",
        ),
    ] = False,
) -> Answer:
    """Simulate the interaction of robot, tissue and surgeon, and measure safety and agility.

    Scenarios are in the spec; without any, the command of thesis fig. 6.7 moves into the first
    environment and out again. A run proves nothing: it shows one thing that may happen.

    Example: nrs-design simulate docs/examples/scenarios.nrs.yaml --out runs

    Example: nrs-design simulate docs/examples/scenarios.nrs.yaml --worst-case
    """
    from nrs_design.cli.simulate_scenarios import simulate_scenarios, worst_case
    from nrs_design.pipeline.runs import run_interaction_of
    from nrs_design.pipeline.scenarios import Runs

    timed = any(value is not None for value in (period, delay, outer_period))
    if engine == "exact" and timed:
        raise typer.BadParameter("the exact engine has no samples", param_hint="--engine")
    if worst and any((scenario, engine, period, delay is not None, outer_period, max_steps)):
        message = "the adversary plays against the loop of the spec, not within a scenario"
        raise typer.BadParameter(message, param_hint="--worst-case")
    loaded = take_spec(spec)
    if engine is None and timed:
        engine = "sampled"
    names = tuple(dict.fromkeys(scenario or ()))
    settings = Runs(names, engine, period, delay, max_steps, outer_period)
    with progress(f"simulating {loaded.spec.name}") as step:
        designed, certificate_read = run_interaction_of(
            loaded, certificate, "describes no interaction", step
        )
        prove = partial(_proof, designed, certificate_read, step, bound=bound)
        if worst:
            return worst_case(designed, prove(), out, step)
        return simulate_scenarios(designed, settings, prove, out, step)


def _proof(
    designed: Designed, certificate: Certificate | None, step: Progress, *, bound: bool
) -> Certificate | None:
    """Return the certificate whose bounds the runs show; None without a certificate."""
    if certificate is not None or not bound or designed.spec.disturbances is None:
        return certificate
    from nrs_design.pipeline.certification import certify_design

    step("certifying its bounds")
    return certify_design(designed.loaded, designed, progress=step).certificate
