"""A block triangular family: its structure, and what is shown for each block."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.proof.evidence import AbstractEvidence, BlockTriangular, Shows
from nrs_design.proof.evidence.block_triangular import diagonal_block
from nrs_design.proof.mode import Time
from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.document import Block, Bullets, Illustration, Paragraph, Section, Table
from nrs_design.reporting.figures.blocks import draw_blocks
from nrs_design.reporting.figures.run import draw_run
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.kinds.abstract import AbstractKindPage
from nrs_design.reporting.kinds.shared import words
from nrs_design.reporting.kinds.shared.run import (
    BESIDE,
    EUCLIDEAN,
    GREEDY,
    bound_line,
    freely,
    horizon,
    phase_plane,
    simulated,
    some_modes,
    trials_per_step,
    until_small,
)
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.simulation.norms import quadratic_norm
from nrs_design.simulation.switched import norms, worst_direction, worst_switching

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
_DECIDED = (
    "the zeros between the blocks are found in the exact matrices, and each block's evidence "
    "is decided in integer arithmetic. Solvers only proposed it"
)


class BlockTriangularPage(AbstractKindPage[BlockTriangular]):
    """The blocks, and in few words what is shown of each.

    What refutes a block is said and drawn as its own page says it.
    """

    @property
    def name(self) -> str:
        """Its kind."""
        return "blocks of its own"

    def meaning(self) -> tuple[str, ...]:
        """Say what follows for the family from its blocks."""
        if self.evidence.shows is Shows.STABILITY:
            return (
                _BOUND,
                *words.unneeded_constant(self.system),
                *words.unneeded_rules(self.system),
                words.decision(_DECIDED),
            )
        inner = self._deciding().meaning()
        if self.evidence.shows is Shows.NO_COMMON_QUADRATIC:
            return inner
        return (
            "The states of one block move by themselves once the later blocks are at rest, so a "
            "family with an unstable block is unstable.",
            *inner,
        )

    def between_corners(self) -> tuple[str, ...]:
        """Say that they are covered."""
        return (words.all_corners(self.system, self.evidence),)

    def limits(self) -> tuple[str, ...]:
        """Say what a refutation of one block leaves open."""
        if self.evidence.shows is Shows.STABILITY:
            return ()
        return self._deciding().limits()

    def sections(self, *, first: bool = True) -> tuple[Section, ...]:
        """Draw the structure and summarize the evidence for the blocks."""
        blocks: list[Block] = []
        if first:
            blocks = [Paragraph(_STRUCTURE), self._illustration(), self._table()]
        if self.evidence.shows is Shows.NO_COMMON_QUADRATIC:
            return (self._without_function(blocks),)
        claims = tuple(
            f"Block {index + 1}: {part.claim(inner)}"
            for index, inner, part in list(self._parts())[:_LISTED]
        )
        evidence = Bullets("Evidence of the blocks", claims)
        return (Section("Block triangular structure", (*blocks, evidence)),)

    def run(self) -> Section:
        """Draw a run of the whole family, beside the rate of its slowest block."""
        rate = self.evidence.proved_rate(self.system)
        if rate is None or self.evidence.shows is not Shows.STABILITY:
            return self._deciding().run()
        return self._beside(float(rate))

    def _beside(self, rate: float) -> Section:
        system, identity = self.system, np.eye(self.system.order)
        hardest = hardest_modes(system, None, trials_per_step(system))
        norm, (step, steps) = quadratic_norm(identity), horizon(hardest, rate)
        initial = worst_direction(hardest, identity)
        response = worst_switching(hardest, norm, initial, step, steps)
        response = until_small(response, norms(response, norm))
        line = bound_line(response, rate, system.time, "slope of the slowest block, ")
        run = Illustration(
            "run",
            BESIDE,
            f"{GREEDY} The dashed line has the rate of the slowest block. The certificate says "
            "that every run decays at any slower rate, up to a constant factor; so the run may "
            f"lie above the line for a while.{freely(system)}{some_modes(system, hardest)}",
            draw_run(response, norms(response, norm), line, hardest, EUCLIDEAN),
        )
        return simulated(run, *phase_plane(hardest, response, None))

    def _parts(self) -> Iterator[tuple[int, SwitchedSystem, AbstractEvidence]]:
        """Yield the number of a block, its family, and what is shown of it."""
        for index, part in self.evidence.parts:
            yield index, diagonal_block(self.system, self.evidence.blocks[index]), part

    def _deciding(self) -> AbstractKindPage[Any]:
        """Return the page of the part that settles the family, which contains its block."""
        _, part = self.evidence.parts[0]
        return _page(self.system, part)

    def _without_function(self, blocks: list[Block]) -> Section:
        """Say which block has no common quadratic function, and why."""
        index, inner, part = next(self._parts())
        text = (
            "A family in block triangular form has a common quadratic function only if every "
            f"family of diagonal blocks has one. Block {index + 1} "
            f"({shortened(inner.states, 6)}) has none."
        )
        why = [block for section in _page(inner, part).sections() for block in section.blocks]
        title = f"No common quadratic function: block {index + 1}"
        return Section(title, (*blocks, Paragraph(text), *why))

    def _illustration(self) -> Illustration:
        return Illustration(
            "blocks",
            "Which states drive which",
            "A filled cell: the state of its column drives the state of its row, in at least one "
            "mode. The frames are the diagonal blocks, each decided by itself; below them all is "
            "zero.",
            draw_blocks(self.system, self.evidence.blocks),
        )

    def _table(self) -> Table:
        system, blocks, parts = self.system, self.evidence.blocks, dict(self.evidence.parts)
        rows = []
        for index, block in list(enumerate(blocks))[:_LISTED]:
            inner, part = diagonal_block(system, block), parts.get(index)
            shown = "not needed" if part is None else _page(inner, part).name
            rate = "" if part is None else _rate(inner, part)
            rows.append((f"{index + 1}", shortened(inner.states, 6), shown, rate))
        unit = "alpha [1/s]" if system.time is Time.CONTINUOUS else "rho per step [1]"
        some = f" (the first {_LISTED})" if len(blocks) > _LISTED else ""
        title = f"The {len(blocks)} diagonal blocks{some}"
        return Table(title, ("Block", "States", "Evidence", f"Proved {unit}"), tuple(rows))


def _page(system: SwitchedSystem, part: AbstractEvidence) -> AbstractKindPage[Any]:
    # Imported here, as the table names this file too.
    from nrs_design.reporting.kinds import page_of

    return page_of(system, part)


def _rate(system: SwitchedSystem, part: AbstractEvidence) -> str:
    rate = part.proved_rate(system)
    if rate is None:
        return ""
    return rounded_down(rate) if system.time is Time.CONTINUOUS else rounded_up(rate)
