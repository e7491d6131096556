"""A block triangular family: its structure, and what is shown for each block."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence import AbstractEvidence, Shows
from nrs_design.proof.evidence.block_triangular import diagonal_block
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Bullets, Illustration, Paragraph, Section, Table
from nrs_design.reporting.evidence import words
from nrs_design.reporting.evidence.page import AbstractPage
from nrs_design.reporting.evidence.runs import (
    BESIDE,
    EUCLIDEAN,
    GREEDY,
    Greedy,
    phase_plane,
    simulated,
    trials_per_step,
)
from nrs_design.reporting.figures.blocks import draw_blocks
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
_CELLS = (
    "A filled cell: the state of its column drives the state of its row, in at least one mode. The "
    "frames are the diagonal blocks, each decided by itself; below them all is zero."
)
_RUN = (
    "The dashed line has the rate of the slowest block. The certificate says that every run decays "
    "at any slower rate, up to a constant factor; so the run may lie above the line for a while."
)


@dataclass(frozen=True)
class BlocksPage(AbstractPage):
    """The blocks, and in few words what is shown of each.

    What refutes a block is said and drawn as its own page says it.
    """

    page_of: Callable[[SwitchedSystem, AbstractEvidence], AbstractPage]  # of what a block shows

    @property
    def name(self) -> str:
        """What it is."""
        return "blocks of its own"

    def meaning(self) -> tuple[str, ...]:
        """Say what follows for the family from its blocks."""
        system = self.system
        if self.evidence.shows is Shows.STABILITY:
            unneeded = (*words.unneeded_constant(system), *words.unneeded_rules(system))
            return (_BOUND, *unneeded, words.decision(system))
        inner = self._deciding.meaning()
        return (_UNSTABLE, *inner) if self.evidence.shows is Shows.INSTABILITY else inner

    def limits(self) -> tuple[str, ...]:
        """Say what a refutation of one block leaves open."""
        return () if self.evidence.shows is Shows.STABILITY else self._deciding.limits()

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Draw the structure and summarize the evidence for the blocks."""
        system, title = self.system, "Block triangular structure"
        blocks: list[Block] = []
        if first:
            figure = draw_blocks(system, self.offer.blocks)
            drawn = Illustration("blocks", "Which states drive which", _CELLS, figure)
            blocks = [Paragraph(_STRUCTURE), drawn, self._table()]
        if self.evidence.shows is Shows.NO_COMMON_QUADRATIC:
            index, inner, part = next(self._parts())
            title = f"No common quadratic function: block {index + 1}"
            states = shortened(inner.states, 6)
            blocks.append(Paragraph(_WITHOUT.format(number=index + 1, states=states)))
            for section in self.page_of(inner, part).sections():
                blocks += section.blocks
        else:
            claims = tuple(
                f"Block {index + 1}: {part.claim(inner)}"
                for index, inner, part in list(self._parts())[:_LISTED]
            )
            blocks.append(Bullets("Evidence of the blocks", claims))
        return (Section(title, tuple(blocks)),)

    def run(self) -> Section:
        """Draw a run of the whole family, beside the rate of its slowest block."""
        proved = self.evidence.proved_rate(self.system)
        if proved is None or self.evidence.shows is not Shows.STABILITY:
            return self._deciding.run()
        system, identity, rate = self.system, np.eye(self.system.order), float(proved)
        hardest = replace(hardest_modes(system, None, trials_per_step(system)), contact=None)
        initial = worst_direction(hardest, identity)
        greedy = Greedy(system, hardest, quadratic_norm(identity), initial, rate)
        line = "slope of the slowest block, "
        response, run = greedy.draw(BESIDE, f"{GREEDY} {_RUN}", EUCLIDEAN, line)
        return simulated(run, *phase_plane(hardest, response, None))

    @property
    def _deciding(self) -> AbstractPage:
        """The page of the part that settles the family, which contains its block."""
        return self.page_of(self.system, self.offer.parts[0][1])

    def _parts(self) -> Iterator[tuple[int, SwitchedSystem, AbstractEvidence]]:
        """Yield the number of a block, its family, and what is shown of it."""
        for index, part in self.offer.parts:
            yield index, diagonal_block(self.system, self.offer.blocks[index]), part

    def _table(self) -> Table:
        system, blocks, parts = self.system, self.offer.blocks, dict(self.offer.parts)
        rows = []
        for index, block in list(enumerate(blocks))[:_LISTED]:
            inner, part = diagonal_block(system, block), parts.get(index)
            shown = "not needed" if part is None else self.page_of(inner, part).name
            rate = "" if part is None else _rate(inner, part)
            rows.append((f"{index + 1}", shortened(inner.states, 6), shown, rate))
        unit = "rho per step [1]" if self.is_discrete else "alpha [1/s]"
        some = f" (the first {_LISTED})" if len(blocks) > _LISTED else ""
        title = f"The {len(blocks)} diagonal blocks{some}"
        return Table(title, ("Block", "States", "Evidence", f"Proved {unit}"), tuple(rows))


def _rate(system: SwitchedSystem, part: AbstractEvidence) -> str:
    rate = part.proved_rate(system)
    if rate is None:
        return ""
    return rounded_down(rate) if system.time is Time.CONTINUOUS else rounded_up(rate)
