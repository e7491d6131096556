"""Arguments and options that several commands share."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path
from typing import Annotated

import typer


def read_work(text: str) -> float:
    """Read a budget of work for an option; raises `typer.BadParameter` on anything else."""
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not value >= 0:
        raise typer.BadParameter(
            f"{text!r} is no budget: give units of work, such as 60, each of about a second"
        )
    return value


SpecFile = Annotated[Path, typer.Argument(metavar="SPEC", help="Spec file (*.nrs.yaml).")]
Verbose = Annotated[bool, typer.Option("--verbose", "-v", help="Print every step.")]


MaxDegree = Annotated[
    int | None,
    typer.Option(
        min=2,
        max=64,
        help="Highest degree of a polynomial function; default: the spec's, or as the budget "
        "allows.",
    ),
]
Budget = Annotated[
    float | None,
    typer.Option(
        metavar="WORK",
        parser=read_work,
        help="Work of each search, counted in units of about a second, the same on every machine; "
        "default: the spec's, or 60.",
    ),
]
Memory = Annotated[
    float | None,
    typer.Option(min=0.0, help="Memory for a step of the search in GB; default 2."),
]

Date = Annotated[
    datetime | None,
    typer.Option(
        "--date",
        formats=["%Y-%m-%d"],
        metavar="YYYY-MM-DD",
        help="Write this date on the page; without it there is no date.",
    ),
]

ReportTo = Annotated[
    Path | None,
    typer.Option("--report", metavar="FILE", help="Write a page with figures (.html)."),
]
