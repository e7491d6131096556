"""Margins of the proof, and next steps where there is none."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from nrs_design.pipeline.blocked import blocked_lines
from nrs_design.pipeline.certification import find_relief
from nrs_design.reporting.document import Block, Bullets, Section
from nrs_design.reporting.margins import margin_lines
from nrs_design.reporting.next_steps import next_steps

if TYPE_CHECKING:
    from nrs_design.pipeline.blocked import Blocked
    from nrs_design.pipeline.certification import Result
    from nrs_design.pipeline.margins import ProofMargins

REMEDIES = "What would help"
MARGINS = "Margins of the proof"
_DESIGN = (
    "Change the design: narrower parameter ranges or fewer contacts per controller, more damping, "
    "modes that are more alike; a longer dwell time or fewer transitions, where the machine can "
    "enforce them."
)


def remedies_section(
    result: Result,
    margins: ProofMargins | None,
    blocked: Blocked | None = None,
) -> Section | None:
    """Report the margins of the proof and the next steps; None without either."""
    blocks: list[Block] = []
    if relief := find_relief(result):
        blocks.append(Bullets("Gains that would hold", relief))
    if blocked is not None:
        why = blocked_lines(blocked, Path(result.loaded.path.name))
        blocks.append(Bullets("Why it is not proved", why))
    lines = () if margins is None else tuple(margin_lines(margins, result.loaded.spec))
    if lines:
        said = tuple(f"{line[0].upper()}{line[1:]}." for line in lines)
        blocks.append(Bullets("How far a proof reaches", said))
    box = margins is not None and margins.box is not None
    dwell = margins is not None and margins.dwell is not None
    steps = next_steps(result, margin=box, shortest_dwell=dwell)
    if steps:
        blocks.append(Bullets("Next steps", (*steps[:-1], _DESIGN, steps[-1])))
    return Section(REMEDIES if steps else MARGINS, tuple(blocks)) if blocks else None
