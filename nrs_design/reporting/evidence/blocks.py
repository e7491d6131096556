"""A block triangular family: its structure, and the evidence for each block."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.evidence.block_triangular import diagonal_block
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Bullets, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.offers import Offer, Page
from nrs_design.reporting.evidence.runs import EUCLIDEAN, Greedy, freely_switched, trials_per_step
from nrs_design.reporting.formatting import list_first
from nrs_design.simulation.norms import quadratic_norm
from nrs_design.simulation.switched import worst_direction

PageOf = Callable[[SwitchedSystem, AbstractEvidence], Page]

_MAX_ROWS = 32
_STRUCTURE = (
    "In every mode, the states of a block are driven by their own block and by later ones only. "
    "So the last block moves by itself, and each of the others follows it."
)
_BOUND = (
    "The bound means: whatever switches happen, the distance from rest shrinks at any rate "
    "slower than that of the slowest block, up to a constant factor in front. Where blocks "
    "are coupled, it may grow for a while before it decays."
)
_UNSTABLE = (
    "The states of one block move by themselves once the later blocks are at rest, so a family "
    "with an unstable block is unstable."
)
_OBSTRUCTION = (
    "A family in block triangular form has a common quadratic function only if every family of "
    "diagonal blocks has one. Block {number} ({states}) has none."
)
_RUN = (
    "The dashed line has the rate of the slowest block. The certificate says that every run decays "
    "at any slower rate, up to a constant factor; so the run may lie above the line for a while."
)


def blocks_page(
    system: SwitchedSystem, evidence: AbstractEvidence, offer: Offer, page_of: PageOf
) -> Page:
    """Return the page of the blocks; a block that settles the family gives its text and run."""
    name, proved = "blocks of its own", evidence.proved_rate(system)
    blocks = [diagonal_block(system, states) for states in offer.blocks]

    def structure() -> tuple[Section, ...]:
        return (_structure(blocks, offer, page_of),)

    if evidence.shows is Shows.STABILITY and proved is not None:
        unneeded = (*words.unneeded_constant(system), *words.unneeded_rules(system))
        meaning, rate = (_BOUND, *unneeded, words.decision(system)), float(proved)
        return Page(name, meaning, (), lambda: _run(system, rate), structure)
    index, part = offer.parts[0]
    if evidence.shows is Shows.NO_COMMON_QUADRATIC:
        inner = page_of(blocks[index], part)
        text = _OBSTRUCTION.format(number=index + 1, states=list_first(blocks[index].states, 6))
        title = f"No common quadratic function: block {index + 1}"

        def obstruction() -> tuple[Section, ...]:
            inner_blocks = (block for section in inner.sections() for block in section.blocks)
            return (Section(title, (Paragraph(text), *inner_blocks)),)

        return replace(inner, name=name, sections=obstruction)
    deciding = page_of(system, part)
    meaning = (_UNSTABLE, *deciding.meaning)
    return replace(deciding, name=name, meaning=meaning, sections=structure)


def _structure(blocks: list[SwitchedSystem], offer: Offer, page_of: PageOf) -> Section:
    """Summarize the evidence for the blocks."""
    parts, discrete = dict(offer.parts), blocks[0].time is Time.DISCRETE
    round_rate = rounded_up if discrete else rounded_down
    rows = []
    for index, block in enumerate(blocks[:_MAX_ROWS]):
        part = parts.get(index)
        proved = None if part is None else part.proved_rate(block)
        name = "not needed" if part is None else page_of(block, part).name
        rate = "" if proved is None else round_rate(proved)
        rows.append((f"{index + 1}", list_first(block.states, 6), name, rate))
    claims = tuple(
        f"Block {index + 1}: {part.claim(blocks[index])}" for index, part in offer.parts[:_MAX_ROWS]
    )
    scope = f" (the first {_MAX_ROWS})" if len(blocks) > _MAX_ROWS else ""
    unit = "rho per step [1]" if discrete else "alpha [1/s]"
    columns = ("Block", "States", "Evidence", f"Proved {unit}")
    table = Table(f"The {len(blocks)} diagonal blocks{scope}", columns, tuple(rows))
    blocks_shown = (Paragraph(_STRUCTURE), table, Bullets("Evidence of the blocks", claims))
    return Section("Block triangular structure", blocks_shown)


def _run(system: SwitchedSystem, rate: float) -> Section:
    """Draw a run of the family with the slope of the slowest block."""
    identity, played = np.eye(system.order), freely_switched(system, None, trials_per_step(system))
    norm, initial = quadratic_norm(identity), worst_direction(played, identity)
    greedy = Greedy(system, played, norm, initial, rate)
    return greedy.draw(_RUN, EUCLIDEAN, "slope of the slowest block, ")
