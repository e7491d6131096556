"""What all identifications share: options, reading with a progress bar, and writing."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from nrs_design.cli.printing import note
from nrs_design.errors import OutputError
from nrs_design.printable import printable

if TYPE_CHECKING:
    from datetime import datetime

    from nrs_design.identification.datasets import Source
    from nrs_design.identification.statistics import Estimate
    from nrs_design.reporting import Report

DataFiles = Annotated[list[Path], typer.Argument(metavar="DATA...", help="Files of data.")]
ColumnMap = Annotated[
    list[str] | None,
    typer.Option("--map", metavar="OURS=THEIRS", help="Foreign column name, as in force_N=Fz."),
]
WriteTo = Annotated[
    Path | None,
    typer.Option("--write", metavar="SPEC", help="Merge the result into this spec file."),
]
ReportTo = Annotated[
    Path | None,
    typer.Option("--report", metavar="FILE", help="Write a page with figures (.html or .pdf)."),
]
SYNTHETIC = "SYNTHETIC data: made by a simulation, not measured."

T = TypeVar("T")


def read_all(
    paths: Sequence[Path],
    read: Callable[[Path, dict[str, str], Callable[[float], None]], T],
    entries: Sequence[str],
    *,
    quiet: bool,
) -> list[T]:
    """Read every file; large ones show how far they are.

    Parameters
    ----------
    paths : sequence of Path
        The files.
    read : callable
        Reads one of them; it takes the columns by name, and a function to tell progress to.
    entries : sequence of str
        ``name=column`` each, as the user gave them.
    quiet : bool
        Show no progress.
    """
    from nrs_design.identification.datasets.columns import parse_mapping

    mapping = parse_mapping(entries)
    with _bar(quiet=quiet) as begin:
        return [read(path, mapping, begin(path.name)) for path in paths]


@contextmanager
def _bar(*, quiet: bool) -> Iterator[Callable[[str], Callable[[float], None]]]:
    if quiet or not sys.stderr.isatty():
        yield lambda name: lambda fraction: None
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bars:

        def begin(name: str) -> Callable[[float], None]:
            task = bars.add_task(f"reading {escape(printable(name))}", total=1.0)
            return lambda fraction: bars.update(task, completed=fraction)

        yield begin


def check_report(path: Path | None) -> None:
    """Refuse a file type that cannot be written, before the work is done."""
    if path is not None and path.suffix.lower() not in (".html", ".pdf"):
        raise OutputError(
            f"{path.suffix or 'no ending'} is not a type of report",
            path=path,
            remedy="name a file that ends in .html or .pdf",
        )


def write_report(path: Path, report: Report, date: datetime | None) -> None:
    """Write a report in the format that the name of the file says.

    Parameters
    ----------
    path : Path
        Ends in .html or .pdf.
    report : Report
        What is written.
    date : datetime or None
        What the user wants to read as its date.
    """
    from nrs_design.output import PAGE, PDF, write_output
    from nrs_design.reporting import render_html, render_pdf

    report = replace(report, date=date.date() if date else None)
    if path.suffix.lower() == ".pdf":
        write_output(path, render_pdf(report), replaces=PDF)
    else:
        write_output(path, render_html(report), replaces=PAGE)


def write_spec(path: Path, text: str, *, quiet: bool) -> None:
    """Write a spec that has been merged.

    Parameters
    ----------
    path : Path
        The spec, which is replaced.
    text : str
        Its new text.
    quiet : bool
        Do not say so.
    """
    from nrs_design.output import write_output

    write_output(path, text)
    note(f"merged into {path}; run nrs-design gate {path} to prove it", quiet=quiet)


def numbers(estimate: Estimate) -> dict[str, float | None]:
    """Return an estimate for JSON, which has no infinity; None says unlimited."""
    high = estimate.high if math.isfinite(estimate.high) else None
    return {"value": estimate.value, "low": estimate.low, "high": high}


def sources(files: Iterable[Source]) -> list[dict[str, Any]]:
    """Return what identifies the data files, for JSON."""
    return [
        {"file": str(file.path), "sha256": file.sha256, "synthetic": file.synthetic}
        for file in files
    ]


def interval(estimate: Estimate) -> str:
    """Write an estimate with its interval."""
    return str(estimate)
