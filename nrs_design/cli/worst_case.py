"""``nrs-design simulate --worst-case``: what an adversary finds, beside limits and bounds."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.cli.command import Answer
from nrs_design.cli.printing import say
from nrs_design.cli.run_files import check_runs, write_runs
from nrs_design.cli.tables import print_table
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from nrs_design.api.worst import WorstFound
    from nrs_design.certificates.certificate import Certificate
    from nrs_design.pipeline.design import Designed


def worst_case(
    designed: Designed, proof: Certificate | None, out: Path | None, step: Progress
) -> Answer:
    """Search, and write the figure and the table of every run."""
    from nrs_design.api.worst import WorstFound
    from nrs_design.output import WORST_RUN
    from nrs_design.pipeline.worst_case import run_worst_case
    from nrs_design.reporting.worst_case import response_of
    from nrs_design.simulation.worst_outputs import DEFLECTION

    begun = f"{designed.spec.name}.worst-"
    names = (f"{begun}{name}" for name in ("force", "velocity", DEFLECTION))
    check_runs(out, names, WORST_RUN)
    case = run_worst_case(designed, proof, progress=step)
    found = WorstFound(designed, case)
    step("figures")
    runs = (
        (f"{begun}{run.output.name}", response_of(case, run).to_csv(), found.plot(run.output.name))
        for run in case.runs
    )
    written = write_runs(out, runs, WORST_RUN)
    return Answer(lambda: found.to_dict() | {"files": written}, lambda: _show(found))


def _show(found: WorstFound) -> None:
    from nrs_design.reporting.worst_case import COLUMNS, LEFT_OUT, UNDECLARED, meaning, worst_rows

    case, spec = found.case, found.designed.spec
    title = f"{spec.name}: the worst that an adversary found"
    print_table(title, COLUMNS, worst_rows(case, spec))
    say(meaning(case))
    if not case.declared:
        say(UNDECLARED)
    say(f"not in it: {LEFT_OUT}")
