"""Proved, refuted and undecided over stiffness and delay."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.certificates.certificate import Verdict
from nrs_design.reporting.style import BLUE, INK, MUTED, VERMILLION, legend, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.patches import Rectangle as Cell

    from nrs_design.pipeline.stability_map import StabilityMap

# Colour, letters and hatching: not only a colour tells how a cell stands.
_LOOKS = {
    Verdict.PROVED: (BLUE, "", "proved", "P"),
    Verdict.INCONCLUSIVE: (MUTED, "..", "undecided", "?"),
    Verdict.REFUTED: (VERMILLION, "//", "refuted", "R"),
}


@styled
def draw_stability_map(found: StabilityMap) -> Figure:
    """Draw a cell for each decision, the declared one framed."""
    from nrs_design.plotting import Rectangle

    figure, axes = new_axes(1.6 + 0.42 * len(found.delays))
    for (row, column), verdict in found.verdicts.items():
        axes.add_patch(_cell(verdict, (column - 0.5, row - 0.5)))
        sign = _LOOKS[verdict][3]
        axes.text(column, row, sign, ha="center", va="center", fontsize=9, color=INK)
    for verdict in dict.fromkeys(found.verdicts.values()):
        label = f"{_LOOKS[verdict][3]}: {_LOOKS[verdict][2]}"
        # Outside of what is drawn: for the legend alone.
        axes.add_patch(_cell(verdict, (-9.0, -9.0), label))
    if 1 in found.factors and found.delay in found.delays:
        corner = (found.factors.index(1) - 0.5, found.delays.index(found.delay) - 0.5)
        frame = Rectangle(corner, 1, 1, fill=False, edgecolor=INK, linewidth=2.0, zorder=3)
        frame.set_label("declared upper ends")
        axes.add_patch(frame)
    axes.set_xlim(-0.5, len(found.factors) - 0.5)
    axes.set_ylim(-0.5, len(found.delays) - 0.5)
    axes.set_xticks(range(len(found.factors)), list(map(str, found.factors)))
    axes.set_yticks(range(len(found.delays)), [str(delay) for delay in found.delays])
    axes.grid(visible=False)
    axes.set_xlabel("Largest stiffness, over the declared one [1]")
    axes.set_ylabel("Oldest force sample")
    legend(figure, axes, 2)
    return figure


def _cell(verdict: Verdict, corner: tuple[float, float], label: str = "") -> Cell:
    from nrs_design.plotting import Rectangle

    tint, hatch, _, _ = _LOOKS[verdict]
    cell = Rectangle(corner, 1, 1, facecolor=tint, edgecolor=INK, linewidth=0.5, alpha=0.3)
    cell.set_hatch(hatch)
    cell.set_label(label)
    return cell
