"""A block triangular family: its structure, and what is shown for each block."""

from __future__ import annotations

from nrs_design.certificates.evidence import (
    AbstractEvidence,
    BlockTriangular,
    CommonPolynomial,
    NoCommonQuadratic,
    Shows,
)
from nrs_design.certificates.evidence.block_triangular import diagonal_block
from nrs_design.reporting.document import Block, Bullets, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.blocks import draw_blocks
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.sections.no_common_quadratic import obstruction_blocks
from nrs_design.spec.bounds import rounded_down, rounded_up
from nrs_design.switched.system import SwitchedSystem, Time

_LISTED = 32
_STRUCTURE = (
    "In every mode, the states of a block are driven by their own block and by later ones only. "
    "So the last block moves by itself, and each of the others follows it."
)
_NAMES = {
    "common-quadratic": "common quadratic function",
    "mode-quadratic": "quadratic function of each mode",
    "no-common-quadratic": "no common quadratic function exists",
    "unstable-mode": "a mode that is not stable",
    "unstable-mixture": "an average that is not stable",
    "unstable-period": "a period that grows",
}


def blocks_section(
    system: SwitchedSystem, evidence: BlockTriangular, *, pattern: bool = True
) -> Section:
    """Draw the structure and summarize the evidence for the blocks.

    Parameters
    ----------
    system : SwitchedSystem
        The whole family.
    evidence : BlockTriangular
        The blocks and their evidence.
    pattern : bool
        Draw the structure; once is enough in a report.
    """
    blocks: list[Block] = [Paragraph(_STRUCTURE)] if pattern else []
    if pattern:
        blocks += [_illustration(system, evidence), _table(system, evidence)]
    if evidence.shows is Shows.NO_COMMON_QUADRATIC:
        return _without_function(system, evidence, blocks)
    claims = tuple(
        f"Block {index + 1}: {part.claim(diagonal_block(system, evidence.blocks[index]))}"
        for index, part in evidence.parts[:_LISTED]
    )
    return Section(
        "Block triangular structure", (*blocks, Bullets("Evidence of the blocks", claims))
    )


def _without_function(
    system: SwitchedSystem, evidence: BlockTriangular, blocks: list[Block]
) -> Section:
    """Say which block has no common quadratic function, and why."""
    index, part = evidence.parts[0]
    inner = diagonal_block(system, evidence.blocks[index])
    text = (
        "A family in block triangular form has a common quadratic function only if every family "
        f"of diagonal blocks has one. Block {index + 1} ({shortened(inner.states, 6)}) has none."
    )
    if isinstance(part, NoCommonQuadratic):
        blocks = [*blocks, Paragraph(text), *obstruction_blocks(inner, part)]
    return Section(f"No common quadratic function: block {index + 1}", tuple(blocks))


def _illustration(system: SwitchedSystem, evidence: BlockTriangular) -> Illustration:
    return Illustration(
        "blocks",
        "Which states drive which",
        "A filled cell: the state of its column drives the state of its row, in at least one mode. "
        "The frames are the diagonal blocks, each decided by itself; below them all is zero.",
        draw_blocks(system, evidence.blocks),
    )


def _table(system: SwitchedSystem, evidence: BlockTriangular) -> Table:
    parts = dict(evidence.parts)
    rows = []
    for index, block in list(enumerate(evidence.blocks))[:_LISTED]:
        states = shortened([system.states[i] for i in block], 6)
        part = parts.get(index)
        shown = "not needed" if part is None else _kind(part)
        rate = "" if part is None else _rate(diagonal_block(system, block), part)
        rows.append((f"{index + 1}", states, shown, rate))
    unit = "alpha [1/s]" if system.time is Time.CONTINUOUS else "rho per step [1]"
    some = f" (the first {_LISTED})" if len(evidence.blocks) > _LISTED else ""
    title = f"The {len(evidence.blocks)} diagonal blocks{some}"
    return Table(title, ("Block", "States", "Evidence", f"Proved {unit}"), tuple(rows))


def _kind(part: AbstractEvidence) -> str:
    if isinstance(part, CommonPolynomial):
        return f"polynomial of degree {2 * part.degree}"
    return _NAMES.get(part.kind, part.kind)


def _rate(system: SwitchedSystem, part: AbstractEvidence) -> str:
    rate = part.proved_rate(system)
    if rate is None:
        return ""
    return rounded_down(rate) if system.time is Time.CONTINUOUS else rounded_up(rate)
