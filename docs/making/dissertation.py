"""Numbers of the dissertation beside recomputed ones, and the errors of its print."""

from __future__ import annotations

from functools import cache

from making.tables import cell
from nrs_design.thesis.comparison import PrintVerdict, ReproducedValue
from nrs_design.thesis.table import counts_line, printed_errors, reproduce

# Rows of the first have a table of their own; of the others there is nothing to compare.
ELSEWHERE = {PrintVerdict.PRINTED_DIFFERENTLY, PrintVerdict.NOT_REPRODUCIBLE}


@cache
def rows() -> tuple[ReproducedValue, ...]:
    """Recompute everything, once for both tables."""
    return reproduce()


def reproduced_table() -> str:
    """Count all rows, and list those that come out or are derived."""
    lines = [
        counts_line(rows()),
        "",
        "| where | quantity | printed | recomputed | unit | verdict |",
        "|---|---|---|---|---|---|",
    ]
    for row in rows():
        if row.verdict not in ELSEWHERE:
            texts = (row.section, row.name, row.printed, row.value or "", row.unit, row.verdict)
            lines.append(f"| {' | '.join(cell(str(text)) for text in texts)} |")
    return "\n".join(lines)


def misprints_table() -> str:
    """List each error of the print once, with the rows that are printed differently for it."""
    lines = [
        "| error | where | quantity | printed | recomputed | unit | why |",
        "|---|---|---|---|---|---|---|",
    ]
    for error, touched in printed_errors(rows()):
        for row in touched:
            about = error.about if row is touched[0] else ""
            texts = (about, row.section, row.name, row.printed, row.value or "", row.unit, row.note)
            lines.append(f"| {' | '.join(cell(text) for text in texts)} |")
    return "\n".join(lines)
