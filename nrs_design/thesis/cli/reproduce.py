"""``nrs-design reproduce``: the numbers of the thesis, print beside recomputed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import insist, note, progress, say
from nrs_design.cli.tables import print_table

if TYPE_CHECKING:
    from nrs_design.thesis.comparison import ReproducedValue


@command("reproduce")
def reproduce(
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the table as an HTML page, too.")
    ] = None,
) -> Answer:
    """Recompute the numbers that the thesis prints, and say which are printed differently.

    Exit code 0: every row is what it is on record to be. 1: a recomputed value has drifted.

    Example: nrs-design reproduce --html reports/reproduce.html
    """
    from nrs_design.output import PAGE, check_html, check_place, write_output
    from nrs_design.thesis.comparison import drifted
    from nrs_design.thesis.table import render_page
    from nrs_design.thesis.table import reproduce as recompute

    if html is not None:
        check_html(html)
        check_place(html, PAGE)
    with progress("recomputing") as step:
        table = recompute(step)
    if html is not None:
        write_output(html, render_page(table), replaces=PAGE)
        note(f"page written to {html}")
    for row in drifted(table):
        insist(f"drift: {row.section} {row.name}: {row.value} {row.unit}, printed {row.printed}")
    return Answer(lambda: _summary(table), lambda: _print(table), exit_codes.unless(drifted(table)))


def _summary(table: tuple[ReproducedValue, ...]) -> dict[str, Any]:
    from dataclasses import asdict

    from nrs_design.thesis.comparison import drifted
    from nrs_design.thesis.table import CONVERTED, count_verdicts, counts_line, printed_errors

    return {
        "summary": counts_line(table),
        "counts": count_verdicts(table),
        "errors_of_the_print": [
            asdict(error) | {"rows": [row.name for row in error_rows]}
            for error, error_rows in printed_errors(table)
        ],
        "drift": [row.name for row in drifted(table)],
        "rows": [asdict(row) for row in table],
        "source": CONVERTED,
    }


def _print(table: tuple[ReproducedValue, ...]) -> None:
    from nrs_design.thesis.table import CONVERTED, counts_line, format_within, printed_errors

    off = ["off the print\n(its precision)", "off our reference\n(drift beyond)"]
    print_table(
        "",
        ["section", "quantity", "printed", "recomputed", "unit", *off, "verdict"],
        [
            [
                *(row.section, row.name, row.printed, row.value or "", row.unit),
                format_within(row.deviation, row.precision),
                format_within(row.drift, row.limit),
                str(row.verdict),
            ]
            for row in table
        ],
    )
    for row in table:
        if row.note or row.fitted:
            fitted = f"Fitted: {row.fitted}. " if row.fitted else ""
            say(f"{row.section} {row.name}: {fitted}{row.note}")
    say()
    errors = [
        [error.id, error.where, error.about, str(len(error_rows))]
        for error, error_rows in printed_errors(table)
    ]
    if errors:
        print_table("Errors of the print", ["error", "where", "what", "rows"], errors)
    say(CONVERTED)
    say(counts_line(table))
