"""``nrs-design simulate``: run the scenarios of a spec, and measure what happens."""

from __future__ import annotations

from dataclasses import asdict
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.options import Json, Quiet, SpecFile
from nrs_design.cli.printing import note, print_json, progress, say
from nrs_design.cli.seconds import seconds
from nrs_design.cli.simulate_options import Jobs, Many, MonteCarloRuns, Resume, Seed, WorstCaseFlag
from nrs_design.cli.tables import print_table

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline import Designed, Progress
    from nrs_design.pipeline.scenarios import CertifiedBound, CertifiedRate, Runs, Simulated
    from nrs_design.spec import InteractionDesignSpec, LoadedSpec


class EngineOption(StrEnum):
    """What simulates."""

    EXACT = "exact"
    SAMPLED = "sampled"
    MUJOCO = "mujoco"


# A run, and the bounds and the rate that are certified beside it.
Bounded = tuple["Simulated", "tuple[CertifiedBound, ...]", "CertifiedRate | None"]


def simulate(
    spec: SpecFile,
    scenario: Annotated[
        list[str] | None,
        typer.Option("--scenario", metavar="NAME", help="One scenario, or several; default: all."),
    ] = None,
    engine: Annotated[
        EngineOption | None,
        typer.Option(
            help="exact: continuous time, from event to event; sampled: the law that ships, in "
            "single precision; mujoco: the same law on MuJoCo's mechanics (extra mujoco), and how "
            "far that is from the sampled engine. Default: sampled where the spec has sampling, "
            "tissue is not linear, or three axes move."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Write SPEC.SCENARIO.svg, .png, .csv and .npz of every run there.",
        ),
    ] = None,
    certificate: Annotated[
        Path | None,
        typer.Option(metavar="CERT", help="Show the bounds of this certificate of the spec."),
    ] = None,
    bound: Annotated[
        bool,
        typer.Option(help="Certify a bound where the spec says what disturbs the loop."),
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
    worst: WorstCaseFlag = False,
    monte_carlo: MonteCarloRuns = None,
    jobs: Jobs = 1,
    seed: Seed = 0,
    resume: Resume = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Simulate the interaction of robot, tissue and surgeon, and measure safety and agility.

    Scenarios are in the spec; without any, the command of thesis fig. 6.7 moves into the first
    environment and out again. A run proves nothing: it shows one thing that may happen.

    Example: nrs-design simulate docs/examples/scenarios.nrs.yaml --out runs

    Example: nrs-design simulate docs/examples/scenarios.nrs.yaml --worst-case

    Example: nrs-design simulate docs/examples/scenarios.nrs.yaml --monte-carlo 500 --jobs 2
    """
    from nrs_design.pipeline import run_design, wrong_kind
    from nrs_design.pipeline.scenarios import Runs, run_scenarios
    from nrs_design.spec import read_spec

    timed = any(value is not None for value in (period, delay, outer_period))
    if engine is EngineOption.EXACT and timed:
        raise typer.BadParameter("the exact engine has no samples", param_hint="--engine")
    of_scenarios = (scenario, engine, period, delay, outer_period, max_steps)
    Many(worst, monte_carlo, seed, jobs, resume).check(of_scenarios)
    loaded = read_spec(spec)
    if loaded.spec.kind != "interaction-design":
        raise wrong_kind(
            loaded,
            f"a spec of kind {loaded.spec.kind} describes no interaction",
            "name a spec of kind interaction-design; see also `nrs-design robot track`",
        )
    how = None if engine is None else str(engine)
    if how is None and timed:
        how = str(EngineOption.SAMPLED)
    wanted = Runs(tuple(dict.fromkeys(scenario or ())), how, period, delay, max_steps, outer_period)
    with progress(f"simulating {loaded.spec.name}", quiet=quiet) as step:
        if worst or monte_carlo is not None:
            many = Many(worst, monte_carlo, seed, jobs, resume)
            show = _simulate_many(loaded, wanted, many, certificate, out, step, bound=bound)
        else:
            _check_places(loaded.spec, scenario, out)
            designed = run_design(loaded)
            assert designed is not None
            found = list(run_scenarios(designed, wanted, step))
            proof = _proof(designed, certificate, step, bound=bound)
            runs = [(one, *_certified(designed, proof, one)) for one in found]
            step("figures")
            files = [str(path) for path in _write(designed, out, runs)]
    if worst or monte_carlo is not None:
        raise typer.Exit(show(as_json=as_json, quiet=quiet))
    if files:
        note(f"written to {out}", quiet=quiet)
    if as_json:
        head = {"spec": loaded.spec.name, "spec_sha256": loaded.sha256}
        print_json("simulate", head | {"runs": [_document(*run) for run in runs], "files": files})
    elif not quiet:
        for run in runs:
            _print(*run)
        say("not modelled:")
        for line in dict.fromkeys(line for one in found for line in one.run.left_out):
            say(f"  - {line}")
    stopped = any(one.run.stopped for one in found)
    raise typer.Exit(exit_codes.INCONCLUSIVE if stopped else exit_codes.PROVED)


def _simulate_many(
    loaded: LoadedSpec,
    wanted: Runs,
    many: Many,
    certificate: Path | None,
    out: Path | None,
    step: Progress,
    *,
    bound: bool,
) -> Callable[..., int]:
    """Let an adversary search, or chance draw; return what prints the result."""
    from nrs_design.cli.monte_carlo import monte_carlo
    from nrs_design.cli.worst_case import worst_case
    from nrs_design.pipeline import run_design
    from nrs_design.pipeline.monte_carlo import MonteCarlo

    designed = run_design(loaded)
    assert designed is not None
    proof = _proof(designed, certificate, step, bound=bound)
    if many.runs is None:
        return worst_case(designed, proof, many.seed, out, step)
    asked = MonteCarlo(designed, wanted, many.runs, many.seed)
    return monte_carlo(asked, many.jobs, many.resume, proof, out, step)


def _proof(
    designed: Designed, file: Path | None, step: Progress, *, bound: bool
) -> Certificate | None:
    """Return the certificate whose bounds are shown, if there is one."""
    from nrs_design.pipeline import run_certification
    from nrs_design.pipeline.scenarios import read_certificate

    if file is not None:
        return read_certificate(file, designed)
    if not bound or designed.spec.disturbances is None:
        return None
    step("certifying its bounds")
    return run_certification(designed.loaded, progress=step).certificate


def _certified(
    designed: Designed, proof: Certificate | None, one: Simulated
) -> tuple[tuple[CertifiedBound, ...], CertifiedRate | None]:
    """Return what is certified beside a run: bounds, and a rate."""
    from nrs_design.pipeline.scenarios import hold_bounds, hold_rate

    if proof is None:
        return (), None
    return hold_bounds(designed, proof, one), hold_rate(designed, proof, one)


def _check_places(
    spec: InteractionDesignSpec, names: Sequence[str] | None, out: Path | None
) -> None:
    """Refuse, before the runs, a folder in which something else stands in the place of a file."""
    from nrs_design.output import check_place
    from nrs_design.simulation.build_scenario import default_names, run_names

    if out is None:
        return
    for name in run_names(spec, tuple(names or spec.scenarios or default_names(spec))):
        for path, beginning in _places(out, spec.name, name).values():
            check_place(path, beginning)


def _places(out: Path, spec: str, scenario: str) -> dict[str, tuple[Path, bytes]]:
    """Return where each file of a run goes, and how one begins that it may replace."""
    from nrs_design.output import ARCHIVE, PNG, RESPONSE, SVG

    beginnings = {"csv": RESPONSE, "npz": ARCHIVE, "svg": SVG, "png": PNG}
    return {
        suffix: (out / f"{spec}.{scenario}.{suffix}", beginning)
        for suffix, beginning in beginnings.items()
    }


def _write(designed: Designed, out: Path | None, runs: Sequence[Bounded]) -> list[Path]:
    """Write every run, once all of them are there."""
    if out is None:
        return []
    from nrs_design.output import write_output
    from nrs_design.reporting.figures.simulated import draw_simulated
    from nrs_design.reporting.images import to_png, to_svg_file
    from nrs_design.simulation.run import common_lever_arm

    limits, files = designed.spec.limits, []
    for one, bounds, _ in runs:
        response = one.run.response
        touched = [surface.environment for surface in one.scenario.surfaces]
        arm = common_lever_arm(designed.spec, touched)
        level = next(((b.level, not b.uncovered) for b in bounds if b.output == "force"), None)
        figure = draw_simulated(response, limits.torque.si, limits.velocity.si, arm, level)
        contents: dict[str, str | bytes] = {
            "csv": response.to_csv(),
            "npz": response.to_npz(),
            "svg": to_svg_file(figure),
            "png": to_png(figure),
        }
        places = _places(out, designed.spec.name, one.scenario.name)
        for suffix, (path, beginning) in places.items():
            write_output(path, contents[suffix], replaces=beginning)
            files.append(path)
    return files


def _document(
    one: Simulated, bounds: tuple[CertifiedBound, ...], rate: CertifiedRate | None
) -> dict[str, Any]:
    run = one.run
    return {
        "scenario": run.scenario,
        "engine": run.engine,
        "seed": one.scenario.seed,
        "stopped": run.stopped,
        "steps": run.steps,
        "refused_samples": run.refused,
        "saturated_samples": run.saturated,
        "deviation_from_sampled": None if run.deviation is None else asdict(run.deviation),
        "not_modelled": list(run.left_out),
        "metrics": dict(one.metrics),
        "limits": dict(one.scenario.limits),
        "switches": [{"time": time, "to": name} for time, name in run.switches],
        "contacts": [
            {"time": time, "environment": name, "made": made} for time, name, made in run.contacts
        ],
        "certified_bounds": [
            {
                "output": b.output,
                "unit": b.unit,
                "level": b.level,
                "holds_for_this_run": not b.uncovered,
                "uncovered": list(b.uncovered),
            }
            for b in bounds
        ],
        "certified_rate": None
        if rate is None
        else {
            "rate": rate.rate,
            "unit": rate.unit,
            "attained": rate.attained,
            "from": rate.start,
            "holds_for_this_run": not rate.uncovered,
            "uncovered": list(rate.uncovered),
        },
    }


def _print(one: Simulated, bounds: tuple[CertifiedBound, ...], rate: CertifiedRate | None) -> None:
    """Print the metrics of a run, bounds beside what they bound."""
    from fractions import Fraction

    from nrs_design.proof.bounds import upper
    from nrs_design.reporting.simulation import metric_rows, rounded_up

    run = one.run
    print_table(f"{run.scenario}: {run.engine} engine", ["", "value", "unit", "limit"],
                metric_rows(one.metrics, one.scenario.limits))  # fmt: skip
    peaks = {"force": one.metrics["peak_torque"], "velocity": one.metrics["peak_velocity"]}
    for b in bounds:
        peak = peaks.get(b.output)
        shown = "" if peak is None else f", simulated peak {rounded_up(peak)} {b.unit}"
        level = upper(Fraction(b.level))
        say(f"  certified bound on the {b.output}: {level} {b.unit}{shown}")
        for reason in b.uncovered:
            say(f"    it is not about this run: {reason}")
    if rate is not None:
        here = "" if rate.start is None else f", here from {rate.start:.6g} s on"
        say(f"  certified decay once nothing is commanded{here}: {_rate(rate)}")
        for reason in rate.uncovered:
            say(f"    it is not about this run: {reason}")
    if run.refused:
        say(f"  the law refused {run.refused} samples: an input was beyond its limits")
    if run.saturated:
        say(f"  the motor's command met its limit at {run.saturated} samples")
    if run.deviation is not None:
        apart = run.deviation
        say(
            f"  from the sampled engine, at most: angle {rounded_up(apart.angle)} rad, velocity "
            f"{rounded_up(apart.velocity)} rad/s, torque {rounded_up(apart.torque)} N m"
        )
    if run.stopped:
        say(f"  STOPPED: {run.stopped}")


def _rate(rate: CertifiedRate) -> str:
    """Return the rate in words, rounded to the safe side."""
    from fractions import Fraction

    from nrs_design.proof.bounds import lower, upper

    number = Fraction(rate.rate)
    text = f"{lower(number)} 1/s" if rate.unit else f"by {upper(number)} a sample"
    return text + ("" if rate.attained else ", or any slower one")
