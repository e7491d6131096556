"""The gallery as one page, and as the fields of a JSON output."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from nrs_design import __version__
from nrs_design.reporting.document import Block, Bullets, Paragraph, Report, Section, Table
from nrs_design.reporting.render import render_html
from nrs_design.thesis.gallery.counterpart import MEASURED, Counterpart, Reproducibility

_COLUMNS = ("statement", "print", "simulated", "outcome", "why")
_MEANINGS = (
    f"{Reproducibility.REPRODUCED}: a statement in words holds in the run; or a number measured on "
    f"the robot is met within {100 * MEASURED:g} % (the thesis's own six displayed impedances miss "
    "the desired one by up to 4.62 %), or within what rounding of the print leaves open.",
    f"{Reproducibility.NOT_REPRODUCED}: it is not, and the reason stands beside it.",
    f"{Reproducibility.OMITTED}: what decides it is not in the thesis, such as the course of a "
    "command. The simulated number is that of inputs of ours, which are listed; if it agrees, that "
    "says nothing.",
    f"{Reproducibility.HARDWARE_ONLY}: no run of this model can show it.",
    f"{Reproducibility.TAKEN}: an instant that the run was laid out for. It agrees because it "
    "was put in.",
)
_FIRST = (
    "The thesis draws records of experiments on the robot. Its figures are not copied here: each "
    "has a run of the model in its place, and beside it what the text of the thesis says of the "
    "figure. Nothing was fitted to the print: an input is from the thesis, or is declared as "
    "chosen. A run proves nothing."
)
FOOTER = "Gallery of nrs-design. Runs are floating-point illustrations; certificates are proofs."


def gallery_page(found: Sequence[Counterpart]) -> str:
    """Return the page; the same counterparts give the same bytes.

    Parameters
    ----------
    found : sequence of Counterpart
        As `draw_counterparts` returns them.
    """
    counts = count_outcomes(found)
    figures = sum(len(one.shows) for one in found)
    report = Report(
        name="Figures of the thesis, simulated",
        title="Figures 6.14 to 6.34 and the six moves of 7.2.2: print beside simulation",
        verdict="simulated",
        claim=_FIRST,
        remarks=(),
        facts=(
            ("Figures", str(figures)),
            *((outcome.capitalize(), str(count)) for outcome, count in counts.items()),
            ("Package", f"nrs-design {__version__}"),
        ),
        sections=(
            Section("Every figure", (_index(found), Bullets("Outcomes", _MEANINGS))),
            *map(_section, found),
        ),
        footer=FOOTER,
    )
    return render_html(report)


def count_outcomes(found: Sequence[Counterpart]) -> dict[str, int]:
    """Return how many statements have each outcome that occurs.

    Parameters
    ----------
    found : sequence of Counterpart
        As `draw_counterparts` returns them.
    """
    outcomes = [statement.outcome for one in found for statement in one.statements]
    return {str(kind): outcomes.count(kind) for kind in Reproducibility if kind in outcomes}


def summarize_gallery(found: Sequence[Counterpart]) -> list[dict[str, Any]]:
    """Return what the page says, as fields.

    Parameters
    ----------
    found : sequence of Counterpart
        As `draw_counterparts` returns them.
    """
    return [
        {
            "figures": list(one.shows),
            "section": one.section,
            "title": one.title,
            "given": list(one.given),
            "chosen": list(one.chosen),
            "remark": one.remark,
            "statements": [
                {
                    "quantity": s.quantity,
                    "printed": s.printed,
                    "simulated": s.simulated,
                    "outcome": str(s.outcome),
                    "why": s.why,
                }
                for s in one.statements
            ],
            "runs": [f"{name}.csv" for name in one.runs],
        }
        for one in found
    ]


def _index(found: Sequence[Counterpart]) -> Table:
    rows = []
    for one in found:
        counts = count_outcomes([one])
        told = ", ".join(f"{count} {outcome}" for outcome, count in counts.items())
        where = f"{one.name}: {one.title}"
        for figure, shows in one.shows.items():
            rows.append((figure, shows, where, told))
    columns = ("figure", "in print", "counterpart, below", "statements")
    return Table("Figures 6.14 to 6.34", columns, tuple(rows))


def _section(one: Counterpart) -> Section:
    shown = tuple(f"{figure}: {text}" for figure, text in one.shows.items())
    blocks: list[Block] = []
    if shown:
        blocks.append(Bullets(f"In print, section {one.section}", shown))
    if one.remark:
        blocks.append(Paragraph(one.remark))
    blocks += one.illustrations
    rows = tuple(
        (s.quantity, s.printed, s.simulated, str(s.outcome), s.why or "–") for s in one.statements
    )
    blocks.append(Table(f"{one.name}: print and run", _COLUMNS, rows))
    blocks.append(Bullets("Inputs from the thesis", one.given))
    if one.chosen:
        blocks.append(Bullets("Inputs of ours, which the thesis omits", one.chosen))
    return Section(f"{one.name}: {one.title}", tuple(blocks))
