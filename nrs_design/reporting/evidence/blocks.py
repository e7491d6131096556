"""A block triangular family: its structure, and the evidence for each block."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

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
from nrs_design.reporting.formatting import shortened
from nrs_design.reporting.sections.modes import hardest_modes
from nrs_design.reporting.style import BLUE, SKY, VERMILLION, legend, new_axes, styled
from nrs_design.reporting.text import wrapped_label
from nrs_design.simulation.norms import quadratic_norm
from nrs_design.simulation.switched import worst_direction

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_LISTED, _NAMED = 32, 12
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
    """The blocks with their evidence; a refuted block has the text and run of its own page."""

    page_of: Callable[[SwitchedSystem, AbstractEvidence], AbstractPage]  # of what a block shows

    name = "blocks of its own"

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
            figure = _draw_blocks(system, self.offer.blocks)
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
        """Yield the number of a block, its family, and its evidence."""
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


@styled
def _draw_blocks(system: SwitchedSystem, blocks: Sequence[Sequence[int]]) -> Figure:
    """Draw which state drives which in any mode, with the diagonal blocks framed."""
    order = [state for block in blocks for state in block]
    label = np.repeat(np.arange(len(blocks)), [len(block) for block in blocks])
    pattern = _pattern(system)[np.ix_(order, order)]
    own = label[:, None] == label[None, :]
    n = len(order)
    figure, axes = new_axes(3.4 if n <= 4 else 4.6)
    size = min(700.0, 26_000.0 / n**2)
    _cells(axes, pattern & own, BLUE, size, "within a block")
    _cells(axes, pattern & ~own, SKY, size, "from a later block")
    _frames(axes, blocks)
    names = [wrapped_label(system.states[i], 14) for i in order]
    ticks = names if n <= _NAMED else [str(i + 1) for i in order]
    shown = range(0, n, 1 + n // 40)
    axes.set_xticks(shown, [ticks[i] for i in shown], rotation=0 if n <= 4 else 60)
    axes.set_yticks(shown, [ticks[i] for i in shown])
    axes.set(xlim=(-0.7, n - 0.3), ylim=(n - 0.3, -0.7), aspect="equal")
    axes.grid(visible=False)
    axes.set(xlabel="State that drives", ylabel="State driven")
    legend(figure, axes, 3)
    return figure


def _pattern(system: SwitchedSystem) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    patterns = [[[v != 0 for v in row] for row in mode.A.numerators] for mode in system.modes]
    return np.asarray(np.any(patterns, axis=0))


def _cells(
    axes: Axes,
    cells: np.ndarray[tuple[int, ...], np.dtype[np.bool_]],
    tint: str,
    size: float,
    label: str,
) -> None:
    rows, columns = np.nonzero(cells)
    if len(rows):
        axes.plot(columns, rows, "s", color=tint, markersize=np.sqrt(size))
        # A marker of the legend's size, whatever the cells' own.
        axes.plot([], [], "s", color=tint, label=label)


def _frames(axes: Axes, blocks: Sequence[Sequence[int]]) -> None:
    start = 0
    for index, block in enumerate(blocks):
        low, high = start - 0.5, start + len(block) - 0.5
        axes.plot(
            [low, high, high, low, low],
            [low, low, high, high, low],
            color=VERMILLION,
            linewidth=1.6,
            label="diagonal block" if index == 0 else None,
        )
        start += len(block)
