"""``nrs-design reproduce``: the numbers of the thesis, print beside recomputed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import insist, note, progress, say
from nrs_design.cli.tables import print_table
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from nrs_design.thesis.comparison import ReproducedValue
    from nrs_design.thesis.figures import Counterpart

_GALLERY = "figures.html"


@command("reproduce")
def reproduce(
    html: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the table as an HTML page, too.")
    ] = None,
    figures: Annotated[
        Path | None,
        typer.Option(
            metavar="FOLDER",
            help="Simulate and draw the records of figures 6.14 to 6.34, and write figures.html "
            "and a CSV of each run there (some ten seconds).",
        ),
    ] = None,
) -> Answer:
    """Recompute the numbers that the thesis prints, and say which are printed differently.

    Exit code 0: every row is what it is on record to be. 1: a recomputed value has drifted.

    Example: nrs-design reproduce --html reports/reproduce.html --figures reports/figures
    """
    from nrs_design.output import PAGE, check_html, check_place, write_output
    from nrs_design.thesis.comparison import drifted
    from nrs_design.thesis.table import render_page
    from nrs_design.thesis.table import reproduce as recompute

    if html is not None:
        check_html(html)
    for page in (html, figures and figures / _GALLERY):
        if page is not None:
            check_place(page, PAGE)
    with progress("recomputing") as step:
        table = recompute(step)
        gallery = None if figures is None else _draw(figures, step)
    if html is not None:
        link = None if figures is None else _link(html, figures / _GALLERY)
        write_output(html, render_page(table, link), replaces=PAGE)
    if html is not None:
        note(f"page written to {html}")
    if figures is not None:
        note(f"figures written to {figures / _GALLERY}")
    for row in drifted(table):
        insist(f"drift: {row.section} {row.name}: {row.value} {row.unit}, printed {row.printed}")
    return Answer(
        lambda: _summary(table, gallery),
        lambda: _print(table),
        exit_codes.unless(drifted(table)),
    )


def _draw(folder: Path, step: Progress) -> tuple[Counterpart, ...]:
    """Write the page of figures and the runs that they show."""
    from nrs_design.output import PAGE, RESPONSE, write_outputs
    from nrs_design.thesis.figures import draw_counterparts, gallery_page

    found = draw_counterparts(step)
    runs = {folder / f"{name}.csv": run for one in found for name, run in one.runs.items()}
    step("writing the page of figures")
    write_outputs(
        [
            (folder / _GALLERY, gallery_page(found), PAGE),
            *((place, run.to_csv(), RESPONSE) for place, run in runs.items()),
        ]
    )
    return found


def _link(page: Path, gallery: Path) -> str:
    """Return where the gallery is, seen from another page."""
    from os.path import realpath, relpath
    from urllib.parse import quote

    return quote(Path(relpath(realpath(gallery), Path(realpath(page)).parent)).as_posix())


def _summary(
    table: tuple[ReproducedValue, ...], gallery: tuple[Counterpart, ...] | None
) -> dict[str, Any]:
    from dataclasses import asdict

    from nrs_design.thesis.comparison import drifted
    from nrs_design.thesis.table import (
        CONVERTED,
        count_verdicts,
        counts_line,
        printed_errors,
    )

    content = {
        "summary": counts_line(table),
        "counts": count_verdicts(table),
        "errors_of_the_print": [
            {
                "id": error.id,
                "where": error.where,
                "about": error.about,
                "rows": [row.name for row in touched],
            }
            for error, touched in printed_errors(table)
        ],
        "drift": [row.name for row in drifted(table)],
        "rows": [asdict(row) for row in table],
        "source": CONVERTED,
    }
    if gallery is not None:
        from nrs_design.thesis.figures import summarize_gallery

        content["figures"] = summarize_gallery(gallery)
    return content


def _print(table: tuple[ReproducedValue, ...]) -> None:
    from nrs_design.thesis.table import CONVERTED, counts_line, format_within, printed_errors

    cells = [
        [
            row.section,
            row.name,
            row.printed,
            row.value or "",
            row.unit,
            format_within(row.deviation, row.precision),
            format_within(row.drift, row.limit),
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
        "off the print\n(its precision)",
        "off our reference\n(drift beyond)",
        "verdict",
    ]
    print_table("", columns, cells)
    for row in table:
        if row.note or row.fitted:
            fitted = f"Fitted: {row.fitted}. " if row.fitted else ""
            say(f"{row.section} {row.name}: {fitted}{row.note}")
    say()
    errors = [
        [error.id, error.where, error.about, str(len(touched))]
        for error, touched in printed_errors(table)
    ]
    if errors:
        print_table("Errors of the print", ["error", "where", "what", "rows"], errors)
    say(CONVERTED)
    say(counts_line(table))
