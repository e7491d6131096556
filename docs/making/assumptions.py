"""What certificates take for granted: each kind with its bound and its test."""

from __future__ import annotations

from making.tables import cell
from nrs_design.certificates.catalogue import kinds


def assumptions_table() -> str:
    """List all kinds of assumptions, but that no rule of switching has to be kept."""
    lines = [
        "| taken for granted | in | within | if it is false | how to test it |",
        "|---|---|---|---|---|",
    ]
    for kind in kinds().values():
        if kind.id != "any-signal":
            texts = (kind.name, kind.where, kind.within, kind.breaks, kind.test)
            lines.append(f"| {' | '.join(map(cell, texts))} |")
    return "\n".join(lines)
