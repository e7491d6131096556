"""A block triangular family: its structure, and the evidence for each block."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.evidence.block_triangular import diagonal_block
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Bullets, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.offers import Offer, Page
from nrs_design.reporting.evidence.runs import BESIDE, EUCLIDEAN, GREEDY, Greedy, trials_per_step
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.norms import quadratic_norm
from nrs_design.simulation.switched import worst_direction

_LISTED = 32
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
_WITHOUT = (
    "A family in block triangular form has a common quadratic function only if every family of "
    "diagonal blocks has one. Block {number} ({states}) has none."
)
_RUN = (
    "The dashed line has the rate of the slowest block. The certificate says that every run decays "
    "at any slower rate, up to a constant factor; so the run may lie above the line for a while."
)


@dataclass(frozen=True)
class _Family:
    system: SwitchedSystem
    offer: Offer
    page_of: Callable[[SwitchedSystem, AbstractEvidence], Page]  # of what a block shows

    def block(self, index: int) -> SwitchedSystem:
        return diagonal_block(self.system, self.offer.blocks[index])

    def structure(self) -> tuple[Section, ...]:
        """Summarize the evidence for the blocks."""
        claims = tuple(
            f"Block {index + 1}: {part.claim(self.block(index))}"
            for index, part in self.offer.parts[:_LISTED]
        )
        blocks = (Paragraph(_STRUCTURE), self._table(), Bullets("Evidence of the blocks", claims))
        return (Section("Block triangular structure", blocks),)

    def obstruction(self) -> tuple[Section, ...]:
        """Show the contradiction in the block that has no common quadratic function."""
        (index, part), *_ = self.offer.parts
        inner = self.block(index)
        text = _WITHOUT.format(number=index + 1, states=shortened(inner.states, 6))
        found = [block for s in self.page_of(inner, part).sections() for block in s.blocks]
        title = f"No common quadratic function: block {index + 1}"
        return (Section(title, (Paragraph(text), *found)),)

    def run(self, rate: float) -> Section:
        """Draw a run of the whole family, beside the rate of its slowest block."""
        system, identity = self.system, np.eye(self.system.order)
        hardest = replace(hardest_modes(system, None, trials_per_step(system)), contact=None)
        initial = worst_direction(hardest, identity)
        greedy = Greedy(system, hardest, quadratic_norm(identity), initial, rate)
        return greedy.draw(BESIDE, f"{GREEDY} {_RUN}", EUCLIDEAN, "slope of the slowest block, ")

    def _table(self) -> Table:
        count, parts, discrete = (
            len(self.offer.blocks),
            dict(self.offer.parts),
            self.system.time is Time.DISCRETE,
        )
        rows = []
        for index in range(min(count, _LISTED)):
            inner, part = self.block(index), parts.get(index)
            proved = None if part is None else part.proved_rate(inner)
            shown = "not needed" if part is None else self.page_of(inner, part).name
            rate = rounded_up(proved) if proved is not None and discrete else ""
            if proved is not None and not discrete:
                rate = rounded_down(proved)
            rows.append((f"{index + 1}", shortened(inner.states, 6), shown, rate))
        unit = "rho per step [1]" if discrete else "alpha [1/s]"
        some = f" (the first {_LISTED})" if count > _LISTED else ""
        columns = ("Block", "States", "Evidence", f"Proved {unit}")
        return Table(f"The {count} diagonal blocks{some}", columns, tuple(rows))


def blocks_page(
    system: SwitchedSystem,
    evidence: AbstractEvidence,
    offer: Offer,
    page_of: Callable[[SwitchedSystem, AbstractEvidence], Page],
) -> Page:
    """Return the page of the blocks; a block that settles the family gives its text and run."""
    name, family = "blocks of its own", _Family(system, offer, page_of)
    proved = evidence.proved_rate(system)
    if evidence.shows is Shows.STABILITY and proved is not None:
        unneeded = (*words.unneeded_constant(system), *words.unneeded_rules(system))
        meaning, rate = (_BOUND, *unneeded, words.decision(system)), float(proved)
        return Page(name, meaning, (), lambda: family.run(rate), family.structure)
    # It contains its block.
    deciding = page_of(system, offer.parts[0][1])
    if evidence.shows is Shows.NO_COMMON_QUADRATIC:
        return replace(deciding, name=name, sections=family.obstruction)
    meaning = (_UNSTABLE, *deciding.meaning)
    return replace(deciding, name=name, meaning=meaning, sections=family.structure)
