"""The worst runs found by an adversary, with limits and certified bounds."""

from __future__ import annotations

from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import Result
from nrs_design.pipeline.design import Designed
from nrs_design.pipeline.scenarios import run_worst_case
from nrs_design.reporting.document import Illustration, Paragraph, Section, Table
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.worst_case import (
    COLUMNS,
    LEFT_OUT,
    UNDECLARED,
    draw_worst,
    meaning,
    worst_rows,
)

_TITLE = "Worst case found"
_CAPTION = (
    "The worst run that was found for the force. Contact, controller and command change between "
    "steps as the adversary likes, within the rules of the spec. No run crosses a dashed line. "
    "`nrs-design simulate --worst-case` draws the worst runs for velocity and deflection, too."
)


def worst_case_section(result: Result) -> Section | None:
    """Show the worst runs found in their units, or say why none is; None for given matrices."""
    designed = result.designed
    if designed is None:
        return None
    try:
        case = run_worst_case(designed, result.certificate)
    except DesignError as error:
        said = f"{error.message[0].upper()}{error.message[1:]}."
        return Section(_TITLE, (Paragraph(said),))
    spec = designed.spec
    undeclared = "" if case.declared else f"{UNDECLARED} "
    rows = tuple(_row(designed, row) for row in worst_rows(case, spec))
    drawn = draw_worst(case, case.runs[0], spec)
    return Section(
        _TITLE,
        (
            Paragraph(
                f"{meaning(case)} {undeclared}Not in it: {LEFT_OUT}. "
                "Floating point, no part of the proof."
            ),
            Table("Worst found, limit and bound", COLUMNS, rows),
            Illustration("worst-case", "The worst run found", _CAPTION, drawn),
        ),
    )


def _row(designed: Designed, row: list[str]) -> tuple[str, ...]:
    """Return a row in which the limit leads to the line that sets it."""
    name, found, unit, limit, *rest = row
    key = "torque" if name == "force" else name
    return (name, found, unit, linked(designed.loaded, limit, "limits", key), *rest)
