"""``nrs-design report``: one page that says and draws everything about a spec."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.options import Budget, Date, MaxDegree, Memory, SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.errors import DesignError

if TYPE_CHECKING:
    from datetime import date as Day

    from nrs_design.certificates.certificate import Certificate
    from nrs_design.reporting import Report
    from nrs_design.spec import LoadedSpec

REPORTS = Path("reports")


@command("report", each_axis=True)
def report(
    spec: SpecFile,
    out: Annotated[Path | None, typer.Option(help="File; default reports/NAME.html.")] = None,
    date: Date = None,
    margin: Annotated[
        bool,
        typer.Option("--margin", help="Add how far ranges, delay and period reach; takes minutes."),
    ] = False,
    shortest_dwell: Annotated[
        bool, typer.Option("--shortest-dwell", help="Add the shortest dwell time; takes minutes.")
    ] = False,
    certificate: Annotated[
        Path | None,
        typer.Option(
            metavar="CERT",
            help="Show what this certificate of the spec proves, checked anew, instead of "
            "searching.",
        ),
    ] = None,
    max_degree: MaxDegree = None,
    budget: Budget = None,
    memory: Memory = None,
) -> Answer:
    """Design, certify, and report it all with figures; the exit code is that of the verdict.

    A robot spec gives a page about workspace, dynamics, correction and balance; the exit code is
    then that of `robot check`.

    Example: nrs-design report specs/neuroboscope/soft-tissue.nrs.yaml
    """
    from nrs_design.pipeline.blocked import find_blocked
    from nrs_design.pipeline.certification import Overrides, search_limits
    from nrs_design.pipeline.margins import run_proof_margins
    from nrs_design.pipeline.runs import run_certification, run_recorded
    from nrs_design.pipeline.scenarios import judged_if_stable
    from nrs_design.reporting import build_report
    from nrs_design.reporting.remedies import next_steps

    loaded, day = take_spec(spec), date.date() if date else None
    place = _place(loaded, out)
    if loaded.spec.kind == "robot":
        if certificate is not None:
            raise DesignError("a robot has no certificate", remedy="leave --certificate out")
        return _report_robot(loaded, place, day)
    limits = search_limits(loaded.spec, Overrides(max_degree, budget, memory))
    searches = {"margin": margin, "shortest_dwell": shortest_dwell}
    with progress(f"reporting {loaded.spec.name}") as step:
        if certificate is None:
            result = run_certification(loaded, limits=limits, progress=step)
        else:
            result = run_recorded(loaded, certificate, step)
        margins = run_proof_margins(result, limits, step, **searches)
        blocked = find_blocked(result, limits, step)
        step("figures")
        analysis = judged_if_stable(
            result.designed, lambda said: note(f"no margins in this report: {said}")
        )
        page = build_report(result, analysis, margins=margins, blocked=blocked, date=day)
        _write(page, place, spec)
    verdict = str(result.certification.verdict)
    steps = next_steps(result, **searches, spec=loaded.path)
    code = exit_codes.VERDICT_CODES[verdict]
    return _answer(loaded, verdict, code, place, result.certificate, steps)


def _answer(
    loaded: LoadedSpec,
    verdict: str,
    code: int,
    place: Path,
    certificate: Certificate | None = None,
    steps: tuple[str, ...] = (),
) -> Answer:
    def facts() -> dict[str, Any]:
        return {
            **loaded.facts,
            "verdict": verdict,
            "certificate_id": certificate.id if certificate else None,
            "files": [str(place)],
        }

    def show() -> None:
        decided = verdict if verdict in exit_codes.VERDICT_CODES else ""
        say(f"{loaded.spec.name}: {decided.upper() or verdict}", verdict=decided)
        for line in steps:
            say(f"next: {line}")
        note(f"written to {place}")

    return Answer(facts, show, code)


def _place(loaded: LoadedSpec, out: Path | None) -> Path:
    """Return where the page goes; refuse, before minutes of work, where something else stands."""
    from nrs_design.certificates.ownership import check_owner, check_page
    from nrs_design.output import PAGE, check_html, check_place

    place = out or REPORTS / f"{loaded.spec.name}.html"
    check_html(place)
    if out is None and loaded.spec.kind != "robot":
        check_owner(loaded.path, loaded.spec.name, REPORTS)
    else:
        check_page(loaded.path, place)
    check_place(place, PAGE)
    return place


def _report_robot(loaded: LoadedSpec, place: Path, date: Day | None) -> Answer:
    """Report a robot, with the exit code of `robot check`."""
    from nrs_design.pipeline.design import placed
    from nrs_design.wings import load_wing

    with progress(f"reporting {loaded.spec.name}"):
        _, robot_spec, robot = load_wing("robot", "pipeline").run_robot(loaded.path)
        pages = load_wing("robot", "reporting.robot")
        with placed(loaded):
            page: Report = pages.robot_report(loaded, robot_spec, robot, date)
        _write(page, place, loaded.path)
    return _answer(loaded, page.verdict, exit_codes.unless(page.verdict != "reachable"), place)


def _write(report: Report, place: Path, spec: Path) -> None:
    from nrs_design.certificates.ownership import origin_of
    from nrs_design.output import PAGE, write_output
    from nrs_design.reporting import render_html

    write_output(place, render_html(report, origin_of(spec, place)), replaces=PAGE)
