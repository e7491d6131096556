"""``nrs-design report``: one page that says and draws everything about a spec."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.options import Budget, Json, MaxDegree, Memory, Quiet, SpecFile
from nrs_design.cli.printing import note, print_json, progress
from nrs_design.errors import DesignError

if TYPE_CHECKING:
    from nrs_design.design.evidence import DesignEvidence
    from nrs_design.pipeline import Result
    from nrs_design.reporting import Report


class FormatOption(StrEnum):
    """File formats of a report."""

    HTML = "html"
    PDF = "pdf"
    PNG = "png"


def report(
    spec: SpecFile,
    file_format: Annotated[
        FormatOption, typer.Option("--format", help="A page, a document, or one image per figure.")
    ] = FormatOption.HTML,
    out: Annotated[
        Path | None,
        typer.Option(
            help="File (a folder for png); default reports/NAME.html, .pdf or reports/NAME."
        ),
    ] = None,
    times: Annotated[
        bool,
        typer.Option("--times", help="Add the time of every rung; pages then differ each time."),
    ] = False,
    max_degree: MaxDegree = None,
    budget: Budget = None,
    memory: Memory = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Design, certify, and report it all with figures; the exit code is that of the verdict.

    Example: nrs-design report specs/neuroboscope/soft-tissue.nrs.yaml --format pdf
    """
    from nrs_design.pipeline import Overrides, limits_of, run_certification
    from nrs_design.reporting import build_report
    from nrs_design.spec import read_spec

    loaded = read_spec(spec)
    with progress(f"reporting {loaded.spec.name}", quiet=quiet) as step:
        limits = limits_of(loaded.spec, Overrides(max_degree, budget, memory))
        result = run_certification(loaded, limits=limits, progress=step)
        step("figures")
        page = build_report(result, _evidence(result, quiet=quiet), times=times)
        files = _write(page, file_format, out)
    verdict = str(result.certification.verdict)
    if as_json:
        print_json(
            "report",
            {
                "spec": loaded.spec.name,
                "spec_sha256": loaded.sha256,
                "verdict": verdict,
                "certificate_id": result.certificate.id if result.certificate else None,
                "files": [str(path) for path in files],
            },
        )
    else:
        print(f"{loaded.spec.name}: {verdict.upper()}")
        for path in files:
            note(f"written to {path}", quiet=quiet)
    raise typer.Exit(exit_codes.OF_VERDICT[verdict])


def _evidence(result: Result, *, quiet: bool) -> DesignEvidence | None:
    """Return what the design achieves, or nothing where a nominal loop has no margins."""
    from nrs_design.pipeline import run_evidence

    if result.design is None:
        return None
    try:
        return run_evidence(result.loaded, result.design)
    except DesignError as error:
        note(f"no margins in this report: {error.message}", quiet=quiet)
        return None


def _write(report: Report, file_format: FormatOption, out: Path | None) -> list[Path]:
    from nrs_design.output import write_output
    from nrs_design.reporting import render_html, render_pdf, render_png

    folder = Path("reports")
    if file_format is FormatOption.PNG:
        folder = out or folder / report.name
        images = {folder / f"{name}.png": data for name, data in render_png(report).items()}
        for path, data in images.items():
            write_output(path, data)
        return list(images)
    path = out or folder / f"{report.name}.{file_format}"
    write_output(
        path, render_pdf(report) if file_format is FormatOption.PDF else render_html(report)
    )
    return [path]
