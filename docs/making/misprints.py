"""Rows of ``reproduce`` in which the dissertation's print is wrong, as a table."""

from __future__ import annotations

from making.tables import cell
from nrs_design.reproduction.comparison import PrintVerdict
from nrs_design.reproduction.table import reproduce


def misprints_table() -> str:
    """Recompute everything, and list what is printed wrongly with what is right."""
    lines = [
        "| where | quantity | printed | recomputed | unit | why |",
        "|---|---|---|---|---|---|",
    ]
    for row in reproduce():
        if row.verdict is PrintVerdict.PRINT_IS_WRONG:
            texts = (row.section, row.name, row.printed, row.value or "", row.unit, row.note)
            lines.append(f"| {' | '.join(cell(text) for text in texts)} |")
    return "\n".join(lines)
