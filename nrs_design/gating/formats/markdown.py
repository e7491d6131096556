"""For the summary of a job and the comment of a review: Markdown, the sum first."""

from __future__ import annotations

from nrs_design.gating.formats.text import COLUMNS, line_of, rows_of, summary_line
from nrs_design.gating.obligations import GateOutcome
from nrs_design.printable import printable

# What Markdown or HTML would take for markup.
_MARKUP = str.maketrans({c: f"&#{ord(c)};" for c in "\\`*_{}[]<>()#+-!|&~@:"})


def to_markdown(outcome: GateOutcome) -> str:
    """Return the sum, what is not fulfilled or weaker than the base, and a row for each spec."""
    sign = "❌" if outcome.broken else "✅"
    parts = [f"### {sign} nrs-design: {_plain(summary_line(outcome))}", ""]
    if outcome.broken:
        parts += [*(f"- {_plain(line_of(item))}" for item in outcome.findings), ""]
    if outcome.changes is not None:
        others = len(outcome.changes.others)
        parts += [f"Against the base: {outcome.changes.weaker} weaker, {others} other changes.", ""]
    parts += ["<details><summary>every spec</summary>", "", *_table(outcome), "", "</details>"]
    return "\n".join(parts) + "\n"


def _table(outcome: GateOutcome) -> list[str]:
    rows = [COLUMNS, ("---",) * len(COLUMNS)]
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return [*lines, *(f"| {' | '.join(map(_plain, row))} |" for row in rows_of(outcome))]


def _plain(text: str) -> str:
    """Write text of strangers so that nothing in it is markup, a link or a mention."""
    return printable(text).translate(_MARKUP)
