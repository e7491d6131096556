"""Errors of the dissertation's print, each once, with the rows of ``reproduce`` that they touch."""

from __future__ import annotations

from making.tables import cell
from nrs_design.thesis.table import printed_errors, reproduce


def misprints_table() -> str:
    """Recompute everything, and list what is printed differently with what is right."""
    lines = [
        "| error | where | quantity | printed | recomputed | unit | why |",
        "|---|---|---|---|---|---|---|",
    ]
    for error, touched in printed_errors(reproduce()):
        for row in touched:
            about = error.about if row is touched[0] else ""
            texts = (about, row.section, row.name, row.printed, row.value or "", row.unit, row.note)
            lines.append(f"| {' | '.join(cell(text) for text in texts)} |")
    return "\n".join(lines)
