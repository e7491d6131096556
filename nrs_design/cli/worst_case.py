"""``nrs-design simulate --worst-case``: what an adversary finds, beside limits and bounds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.cli.command import Answer
from nrs_design.cli.printing import note, say
from nrs_design.cli.run_files import RunFiles, write_runs
from nrs_design.cli.tables import print_table
from nrs_design.facts.spec import spec_facts
from nrs_design.facts.worst_case import worst_case_facts
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.output import Output
    from nrs_design.pipeline.design import Designed
    from nrs_design.pipeline.worst_case import WorstCase


def worst_case(
    designed: Designed, proof: Certificate | None, out: Path | None, step: Progress
) -> Answer:
    """Search, and write the figure and the table of every run."""
    from nrs_design.pipeline.worst_case import run_worst_case
    from nrs_design.simulation.run import common_lever_arm
    from nrs_design.simulation.worst_outputs import DEFLECTION

    if out is not None:
        for name in ("force", "velocity", DEFLECTION):
            _files(designed, out, name).check()
    case = run_worst_case(designed, proof, progress=step)
    step("figures")
    arm = common_lever_arm(designed.spec, designed.spec.touched)
    written = [] if out is None else _write(designed, case, arm, out)
    return Answer(
        lambda: spec_facts(designed.loaded) | worst_case_facts(case) | {"files": written},
        lambda: _show(designed.spec.name, case, arm),
    )


def _show(name: str, case: WorstCase, arm: float | None) -> None:
    from nrs_design.reporting.worst_case import (
        COLUMNS,
        LEFT_OUT,
        MEANING,
        NO_BOUND,
        UNDECLARED,
        worst_rows,
    )

    print_table(f"{name}: the worst that an adversary found", COLUMNS, worst_rows(case, arm))
    say(MEANING if case.bounds else f"{MEANING.partition(';')[0]}. {NO_BOUND}")
    if not case.declared:
        say(UNDECLARED)
    say(f"not in it: {LEFT_OUT}")


def _files(designed: Designed, out: Path, name: str) -> RunFiles:
    from nrs_design.output import WORST_RUN

    return RunFiles(out, f"{designed.spec.name}.worst-{name}", WORST_RUN)


def _write(designed: Designed, case: WorstCase, arm: float | None, out: Path) -> list[str]:
    from nrs_design.reporting.worst_case import draw_worst, response_of

    outputs: list[Output] = []
    for run in case.runs:
        files, response = _files(designed, out, run.output.name), response_of(case, run)
        figure = draw_worst(case, run, arm)
        outputs += files.outputs(response.to_csv(), figure)
    written = write_runs(outputs)
    note(f"written to {out}")
    return written
