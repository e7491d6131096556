"""The pattern of a block triangular family."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.system import SwitchedSystem
from nrs_design.reporting.style import BLUE, SKY, VERMILLION, legend, new_axes, styled
from nrs_design.reporting.text import wrapped_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_NAMED = 12


@styled
def draw_blocks(system: SwitchedSystem, blocks: Sequence[Sequence[int]]) -> Figure:
    """Draw which state drives which in any mode, with the diagonal blocks framed.

    Parameters
    ----------
    system : SwitchedSystem
        Modes.
    blocks : sequence of sequence of int
        Indices of the states of each block, in order.
    """
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
    axes.set_xlim(-0.7, n - 0.3)
    axes.set_ylim(n - 0.3, -0.7)
    axes.set_aspect("equal")
    axes.grid(visible=False)
    axes.set_xlabel("State that drives")
    axes.set_ylabel("State driven")
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
