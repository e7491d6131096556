"""``nrs-design reproduce``: the numbers of the thesis, print beside recomputed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.options import Json, Quiet
from nrs_design.cli.printing import note, print_json, progress, say
from nrs_design.cli.tables import print_table

if TYPE_CHECKING:
    from nrs_design.reproduction.comparison import Comparison


def reproduce(
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the table as an HTML page, too.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Recompute the numbers that the thesis prints, and say which of them are wrong in print.

    Exit code 0: every row is what it is on record to be. 1: a recomputed value has drifted.

    Example: nrs-design reproduce --html reports/reproduce.html
    """
    from nrs_design.output import PAGE, check_place, write_output
    from nrs_design.reproduction.comparison import drifted
    from nrs_design.reproduction.page import render_page
    from nrs_design.reproduction.table import reproduce as recompute

    if html is not None:
        check_place(html, PAGE)
    with progress("recomputing", quiet=quiet) as step:
        table = recompute(step)
    if html is not None:
        write_output(html, render_page(table), replaces=PAGE)
    if as_json:
        print_json("reproduce", _summary(table))
    elif not quiet:
        _print(table)
    if html is not None:
        note(f"page written to {html}", quiet=quiet)
    for row in drifted(table):
        note(f"drift: {row.section} {row.name}: {row.value} {row.unit}, printed {row.printed}")
    raise typer.Exit(exit_codes.REFUTED if drifted(table) else exit_codes.PROVED)


def _summary(table: tuple[Comparison, ...]) -> dict[str, Any]:
    from dataclasses import asdict

    from nrs_design.reproduction.comparison import drifted
    from nrs_design.reproduction.table import count_verdicts

    return {
        "counts": count_verdicts(table),
        "drift": [row.name for row in drifted(table)],
        "rows": [asdict(row) for row in table],
    }


def _print(table: tuple[Comparison, ...]) -> None:
    from nrs_design.reproduction.page import format_deviation
    from nrs_design.reproduction.table import count_verdicts

    cells = [
        [
            row.section,
            row.name,
            row.printed,
            row.value or "",
            row.unit,
            format_deviation(row.deviation),
            row.tolerance,
            str(row.verdict),
        ]
        for row in table
    ]
    columns = [
        "section",
        "quantity",
        "printed",
        "recomputed",
        "unit",
        "deviation",
        "tolerance",
        "verdict",
    ]
    print_table("", columns, cells)
    for row in table:
        if row.note:
            say(f"{row.section} {row.name}: {row.note}")
    say()
    counts = count_verdicts(table)
    say(", ".join(f"{count} {verdict}" for verdict, count in counts.items()))
