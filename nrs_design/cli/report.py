"""``nrs-design report``: one page that says and draws everything about a spec."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command, take_spec
from nrs_design.cli.options import Budget, Date, MaxDegree, Memory, SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.errors import DesignError, OutputError
from nrs_design.facts.spec import spec_facts

if TYPE_CHECKING:
    from datetime import date as Day

    from nrs_design.certificates.certificate import Certificate
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.certification import Result
    from nrs_design.reporting import Report
    from nrs_design.spec import LoadedSpec

REPORTS = Path("reports")


class ReportFormat(StrEnum):
    """File formats of a report."""

    HTML = "html"
    PNG = "png"


@command("report", each_axis=True)
def report(
    spec: SpecFile,
    file_format: Annotated[
        ReportFormat | None,
        typer.Option(
            "--format",
            help="A page, or one image per figure; default: a page.",
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(help="File (a folder for png); default reports/NAME.html or reports/NAME."),
    ] = None,
    times: Annotated[
        bool,
        typer.Option("--times", help="Add the time of every rung; pages then differ each time."),
    ] = False,
    date: Date = None,
    margin: Annotated[
        bool,
        typer.Option("--margin", help="Add how far ranges, delay and period reach; takes minutes."),
    ] = False,
    shortest_dwell: Annotated[
        bool,
        typer.Option("--shortest-dwell", help="Add the shortest dwell time; takes minutes."),
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
    from nrs_design.reporting import build_report
    from nrs_design.reporting.next_steps import next_steps

    loaded, day = take_spec(spec), date.date() if date else None
    file_format = _format_of(file_format, out)
    if loaded.spec.kind == "robot":
        if certificate is not None:
            raise DesignError("a robot has no certificate", remedy="leave --certificate out")
        return _report_robot(loaded, file_format, out, day)
    _check_out(loaded, file_format, out)
    limits = search_limits(loaded.spec, Overrides(max_degree, budget, memory))
    asked = {"margin": margin, "shortest_dwell": shortest_dwell}
    with progress(f"reporting {loaded.spec.name}") as step:
        if certificate is None:
            result = run_certification(loaded, limits=limits, progress=step)
        else:
            result = run_recorded(loaded, certificate, step)
        margins = run_proof_margins(result, limits, step, **asked)
        blocked = find_blocked(result, limits, step)
        step("figures")
        page = build_report(
            result,
            _analysis(result),
            margins=margins,
            blocked=blocked,
            times=times,
            date=day,
        )
        files = _write(page, file_format, out, spec)
    verdict = str(result.certification.verdict)
    steps = next_steps(result, **asked, spec=loaded.path)
    code = exit_codes.OF_VERDICT[verdict]
    return _answer(loaded, verdict, code, files, result.certificate, steps)


def _answer(
    loaded: LoadedSpec,
    verdict: str,
    code: int,
    files: list[Path],
    certificate: Certificate | None = None,
    steps: tuple[str, ...] = (),
) -> Answer:
    def facts() -> dict[str, Any]:
        return {
            **spec_facts(loaded),
            "verdict": verdict,
            "certificate_id": certificate.id if certificate else None,
            "files": [str(path) for path in files],
        }

    def show() -> None:
        if verdict in exit_codes.OF_VERDICT:
            say(f"{loaded.spec.name}: {verdict.upper()}", verdict=verdict)
        else:
            say(f"{loaded.spec.name}: {verdict}")
        for line in steps:
            say(f"next: {line}")
        for path in files:
            note(f"written to {path}")

    return Answer(facts, show, code)


def _format_of(file_format: ReportFormat | None, out: Path | None) -> ReportFormat:
    """Return the format that was asked for, or a page; the ending of the file must agree."""
    from nrs_design.output import PAGES, check_html

    ending = "" if out is None else out.suffix.lower()
    if ending == ".png" and file_format in (None, ReportFormat.PNG):
        raise OutputError("is no folder", path=out, remedy="--format png takes a folder")
    if ending in PAGES and file_format is ReportFormat.PNG:
        raise OutputError(
            f"ends in {ending}, and --format png takes a folder",
            path=out,
            remedy="leave --format out, or name another place",
        )
    if file_format is None and out is not None:
        check_html(out)
    return file_format or ReportFormat.HTML


def _check_out(loaded: LoadedSpec, file_format: ReportFormat, out: Path | None) -> None:
    """Refuse, before minutes of work, a place in which something else stands."""
    from nrs_design.output import PAGE, check_place
    from nrs_design.ownership import check_owner, check_page

    if out is None:
        check_owner(loaded.path, loaded.spec.name, REPORTS)
    else:
        check_page(loaded.path, out)
    if file_format is not ReportFormat.PNG:
        check_place(out or REPORTS / f"{loaded.spec.name}.html", PAGE)


def _report_robot(
    loaded: LoadedSpec,
    file_format: ReportFormat,
    out: Path | None,
    date: Day | None,
) -> Answer:
    """Report a robot, with the exit code of `robot check`."""
    from nrs_design.ownership import check_page
    from nrs_design.pipeline.design import placed
    from nrs_design.wings import load_wing

    spec = loaded.path
    check_page(spec, out or REPORTS / f"{loaded.spec.name}.html")
    with progress(f"reporting {loaded.spec.name}"):
        _, robot_spec, robot = load_wing("robot", "pipeline").run_robot(spec)
        pages = load_wing("robot", "reporting.robot")
        with placed(loaded):
            page: Report = pages.robot_report(loaded, robot_spec, robot, date)
        files = _write(page, file_format, out, spec)
    return _answer(loaded, page.verdict, exit_codes.unless(page.verdict != "reachable"), files)


def _analysis(result: Result) -> DesignAnalysis | None:
    """Return what the design achieves, or nothing where a nominal loop has no margins."""
    from nrs_design.pipeline.analysis import run_judgement

    if result.designed is None:
        return None
    try:
        return run_judgement(result.designed)
    except DesignError as error:
        note(f"no margins in this report: {error.message}")
        return None


def _write(report: Report, file_format: ReportFormat, out: Path | None, spec: Path) -> list[Path]:
    from nrs_design.output import PAGE, PNG, write_output, write_outputs
    from nrs_design.ownership import origin_of
    from nrs_design.reporting import render_html, render_png

    if file_format is ReportFormat.PNG:
        folder = out or REPORTS / report.name
        images = {folder / f"{name}.png": data for name, data in render_png(report).items()}
        write_outputs([(path, data, PNG) for path, data in images.items()])
        return list(images)
    path = out or REPORTS / f"{report.name}.html"
    write_output(path, render_html(report, origin_of(spec, path)), replaces=PAGE)
    return [path]
