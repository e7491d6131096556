"""A table, and a line for every broken obligation, as text or as Markdown for a review."""

from __future__ import annotations

from collections.abc import Sequence
from decimal import Decimal
from fractions import Fraction

from nrs_design.controllers.float32 import round_float32
from nrs_design.gating.obligations import GateOutcome, Obligation, SpecOutcome, count_by_verdict
from nrs_design.gating.rules import NOT_WEAKER
from nrs_design.printable import printable
from nrs_design.proof.text import counted

COLUMNS = ("spec", "verdict", "common quadratic", "decay rate", "modes", "certificate")
SHORT_ID = 12
# Characters that are markup in Markdown or HTML.
_MARKUP = str.maketrans({c: f"&#{ord(c)};" for c in "\\`*_{}[]<>()#+-!|&~@:"})


def format_text(outcome: GateOutcome) -> str:
    """Return the table, the failures worst first, and a line that sums up."""
    parts = [*_table([COLUMNS, *rows_of(outcome)]), *gain_lines(outcome)]
    if outcome.broken:
        parts += ["", *map(line_of, outcome.findings)]
    return "\n".join([*parts, *change_lines(outcome), "", summary_line(outcome)]) + "\n"


def rows_of(outcome: GateOutcome) -> list[Sequence[str]]:
    """Return the cells of the table, a row for each spec; see `COLUMNS`."""
    return [_row(spec) for spec in outcome.specs]


def gain_lines(outcome: GateOutcome) -> list[str]:
    """Return the lines about designed gains, after an empty one; none where there are no gains."""
    designed = [_gains(spec) for spec in outcome.specs if spec.gains]
    title = "gains (single-precision numbers, by their shortest decimals):"
    return ["", title, *designed] if designed else []


def change_lines(outcome: GateOutcome) -> list[str]:
    """Return the section on what differs from the base, after an empty line; nothing without one.

    What is weaker is among the obligations that are not fulfilled.
    """
    found = outcome.changes
    if found is None:
        return []
    counts = (
        f"{found.weaker} weaker ({NOT_WEAKER.id}), {counted(len(found.others), 'other change')}"
    )
    lines = [f"against {found.base.as_posix()}: {counts}"]
    for item in found.others:
        lines.append(f"  {item.path.as_posix()}:{item.line}:{item.column}: {item.message}")
    return ["", *map(printable, lines)]


def _row(spec: SpecOutcome) -> Sequence[str]:
    # A proof of a rate proves every slower rate: the relation holds for the rounded rate, too.
    sign, unit = (">=", " 1/s") if spec.rate_name == "alpha" else ("<=", "")
    return (
        printable(spec.path.as_posix()),
        spec.verdict or "-",
        spec.common_quadratic or "-",
        f"{spec.rate_name} {sign} {spec.rate}{unit}" if spec.rate else "-",
        "-" if spec.modes is None else str(spec.modes),
        (spec.certificate_id or "-")[:SHORT_ID],
    )


def _table(rows: Sequence[Sequence[str]]) -> list[str]:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]
    return [lines[0], "-" * (sum(widths) + 2 * (len(widths) - 1)), *lines[1:]]


def _gains(spec: SpecOutcome) -> str:
    lines = (
        f"{printable(name)} "
        + ", ".join(
            f"{key} {_shortest(text)} {spec.units.get(name, {}).get(key, '')}".rstrip()
            for key, text in gains.items()
        )
        for name, gains in spec.gains.items()
        if gains
    )
    return f"{printable(spec.path)}: {'; '.join(lines)}"


def _shortest(text: str) -> str:
    """Return the shortest decimal that rounds to this single-precision number."""
    value = Fraction(text)
    candidates = (f"{float(value):.{digits}g}" for digits in range(1, 10))
    found = next(short for short in candidates if round_float32(Fraction(short)) == value)
    return f"{Decimal(found):f}"


def line_of(item: Obligation) -> str:
    """Return the line about an obligation that is not fulfilled."""
    place = [item.path.as_posix(), *(str(n) for n in (item.line, item.column) if n is not None)]
    return printable(f"{':'.join(place)}: {item.rule.id} {item.status}: {item.message}")


def summary_line(outcome: GateOutcome) -> str:
    """Return the line that sums up."""
    counts = ", ".join(f"{n} {verdict}" for verdict, n in count_by_verdict(outcome.specs).items())
    broken = len(outcome.broken)
    total = sum(len(spec.obligations) for spec in outcome.specs)
    ending = "all fulfilled" if not broken else f"{broken} not fulfilled (nrs-design explain RULE)"
    specs = counted(len(outcome.specs), "spec")
    return f"{specs}: {counts}; {counted(total, 'obligation')}, {ending}"


def format_markdown(outcome: GateOutcome) -> str:
    """Return the sum, what is not fulfilled or weaker than the base, and a row for each spec."""
    sign = "❌" if outcome.broken else "✅"
    parts = [f"### {sign} nrs-design: {_escape(summary_line(outcome))}", ""]
    if outcome.broken:
        parts += [*(f"- {_escape(line_of(item))}" for item in outcome.findings), ""]
    if outcome.changes is not None:
        others = len(outcome.changes.others)
        parts += [f"Against the base: {outcome.changes.weaker} weaker, {others} other changes.", ""]
    parts += [
        "<details><summary>every spec</summary>",
        "",
        *_markdown_table(outcome),
        "",
        "</details>",
    ]
    return "\n".join(parts) + "\n"


def _markdown_table(outcome: GateOutcome) -> list[str]:
    rows = [COLUMNS, ("---",) * len(COLUMNS)]
    lines = [f"| {' | '.join(row)} |" for row in rows]
    return [*lines, *(f"| {' | '.join(map(_escape, row))} |" for row in rows_of(outcome))]


def _escape(text: str) -> str:
    """Escape markup, links and mentions in a text of others."""
    return printable(text).translate(_MARKUP)
