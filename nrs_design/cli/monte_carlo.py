"""``nrs-design simulate --monte-carlo``: many runs, and the share of them above each limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, spec_facts
from nrs_design.cli.printing import insist, note, say
from nrs_design.cli.run_files import RunFiles, write_runs
from nrs_design.cli.tables import print_table
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline.monte_carlo import MonteCarlo
    from nrs_design.simulation.monte_carlo import Outcome, Share

# By quantity: a certified bound, in SI, and why it is not about these runs.
Bounds = Mapping[str, tuple[float, tuple[str, ...]]]


def monte_carlo(
    asked: MonteCarlo,
    jobs: int,
    resume: Path | None,
    proof: Certificate | None,
    out: Path | None,
    step: Progress,
) -> Answer:
    """Simulate, and write the figure and the table.

    Parameters
    ----------
    asked : MonteCarlo
        What is simulated.
    jobs : int
        Processes.
    resume : Path or None
        Keeps the result of every run.
    proof : Certificate or None
        Whose bounds are shown.
    out : Path or None
        Folder for files.
    step : callable
        Told how far it is.
    """
    from nrs_design.output import OUTCOMES, check_place
    from nrs_design.simulation.monte_carlo import held_against, shares

    files = None
    if out is not None:
        files = RunFiles(out, f"{asked.designed.spec.name}.monte-carlo", OUTCOMES, has_arrays=False)
        files.check()
    if resume is not None:
        # What a file there holds is looked at as it is read.
        check_place(resume)
    certified = {} if proof is None else _bounds(asked, proof)
    outcomes: list[Outcome] = []
    try:
        _simulate(asked, jobs, resume, outcomes, step)
    except KeyboardInterrupt:
        kept = "nothing is kept, for want of --resume FILE"
        if resume is not None:
            kept = f"the same command with --resume {resume} goes on from there"
        insist(f"interrupted after {len(outcomes)} of {asked.runs} runs: {kept}")
        raise typer.Exit(exit_codes.INTERRUPTED) from None
    step("figures")
    found = shares(outcomes, asked.limits)
    bounds = {name: held_against(bound, outcomes) for name, bound in certified.items()}
    written = [] if files is None else _write(asked, files, outcomes, bounds)
    stopped = sum(one.stopped is not None for one in outcomes)
    return Answer(
        lambda: _facts(asked, outcomes, found, bounds) | {"files": written},
        lambda: _show(asked, outcomes, found, bounds, stopped),
        exit_codes.INCONCLUSIVE if stopped else exit_codes.PROVED,
    )


def _simulate(
    asked: MonteCarlo, jobs: int, resume: Path | None, outcomes: list[Outcome], step: Progress
) -> None:
    """Add the runs that are known, and then the others, as they end."""
    from nrs_design.pipeline.monte_carlo import run_monte_carlo
    from nrs_design.simulation.outcomes_file import appending, read_outcomes

    def tell() -> None:
        step(f"run {len(outcomes)} of {asked.runs}")

    if resume is None:
        for outcome in run_monte_carlo(asked, 0, jobs):
            outcomes.append(outcome)
            tell()
        return
    head = _head(asked)
    outcomes += read_outcomes(resume, head)
    with appending(resume, head) as file:
        for outcome in run_monte_carlo(asked, len(outcomes), jobs):
            file.add(outcome)
            outcomes.append(outcome)
            tell()


def _head(asked: MonteCarlo) -> dict[str, Any]:
    from hashlib import sha256

    from nrs_design import __version__

    loaded = asked.designed.loaded
    # A spec names files of commands, which its hash does not hold.
    commands = repr([one.profile for one in asked.scenarios])
    return {
        **spec_facts(loaded),
        "options": asdict(asked.wanted) | {"names": list(asked.wanted.names)},
        "commands_sha256": sha256(commands.encode()).hexdigest(),
        "version": __version__,
        "runs": asked.runs,
        "seed": asked.seed,
    }


def _bounds(asked: MonteCarlo, proof: Certificate) -> dict[str, tuple[float, tuple[str, ...]]]:
    """Return the bounds, and what of the scenarios as written they are not about."""
    from nrs_design.pipeline.certified_runs import hold_bounds
    from nrs_design.pipeline.scenarios import run_scenarios

    names = {"force": "torque"}
    found: dict[str, tuple[float, tuple[str, ...]]] = {}
    for one in run_scenarios(asked.designed, asked.wanted):
        for bound in hold_bounds(asked.designed, proof, one):
            name = names.get(bound.output, bound.output)
            known = found.get(name, (bound.level, ()))[1]
            found[name] = bound.level, tuple(dict.fromkeys((*known, *bound.uncovered)))
    return found


def _write(
    asked: MonteCarlo, files: RunFiles, outcomes: Sequence[Outcome], bounds: Bounds
) -> list[str]:
    from nrs_design.reporting.monte_carlo import draw_outcomes, outcomes_table

    levels = {name: (level, not reasons) for name, (level, reasons) in bounds.items()}
    figure = draw_outcomes(outcomes, asked.limits, levels)
    written = write_runs(files.outputs(outcomes_table(outcomes), figure))
    note(f"written to {files.folder}")
    return written


def _show(
    asked: MonteCarlo,
    outcomes: Sequence[Outcome],
    found: Mapping[str, Share],
    bounds: Bounds,
    stopped: int,
) -> None:
    from nrs_design.reporting.monte_carlo import COLUMNS, MEANING, share_rows

    title = f"{asked.designed.spec.name}: {asked.runs} runs, seed {asked.seed}"
    print_table(title, COLUMNS, share_rows(outcomes, asked.limits, found))
    _say_bounds(bounds)
    if stopped:
        say(f"  STOPPED: {stopped} runs ended early; they count as above every limit")
    say(MEANING)


def _say_bounds(bounds: Bounds) -> None:
    from fractions import Fraction

    from nrs_design.proof.bounds import upper

    for name, (level, reasons) in bounds.items():
        unit = "N*m" if name == "torque" else "rad/s"
        say(f"  certified bound on the {name}: {upper(Fraction(level))} {unit}")
        for reason in reasons:
            say(f"    it is not about these runs: {reason}")


def _facts(
    asked: MonteCarlo, outcomes: Sequence[Outcome], found: Mapping[str, Share], bounds: Bounds
) -> dict[str, Any]:
    names = dict.fromkeys(one.scenario for one in outcomes)
    return {
        **spec_facts(asked.designed.loaded),
        "monte_carlo": {
            "runs": asked.runs,
            "seed": asked.seed,
            "stopped": sum(one.stopped is not None for one in outcomes),
            "scenarios": {name: sum(one.scenario == name for one in outcomes) for name in names},
            "limits": {name: dict(asked.limits[name]) for name in names},
            "above_limit": {
                name: asdict(share) | {"share": share.value} for name, share in found.items()
            },
            "largest": {
                name: max(one.peaks[name] for one in outcomes) for name in outcomes[0].peaks
            },
            "certified_bounds": {
                name: {"level": level, "holds_for_these_runs": not reasons, "uncovered": reasons}
                for name, (level, reasons) in bounds.items()
            },
        },
    }
