"""The gradient iteration beside the LMI: cells of a table, and how the iteration went."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.reporting.style import color, legend, new_figure, styled
from nrs_design.search.gradient_settings import Order

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.search.comparison import History, MethodRun

COLUMNS = ("method", "coordinates", "order", "outcome", "updates", "proved rate", "condition of Q")


def cells_of(run: MethodRun) -> tuple[str, ...]:
    """Write one run in `COLUMNS`."""
    return (
        str(run.method),
        str(run.coordinates or ""),
        str(run.order or ""),
        run.outcome,
        "" if run.updates is None else str(run.updates),
        _rate(run),
        "" if run.condition is None else f"{run.condition:.3g}",
    )


def _rate(run: MethodRun) -> str:
    evidence, system = run.certification.evidence, run.certification.system
    rate = None if evidence is None else evidence.proved_rate(system)
    return "none" if rate is None else rate_words(rate, system.time)


TITLES = {Order.ROUND_ROBIN: "Modes in turn", Order.RANDOM: "Modes at random"}


@styled
def draw_histories(runs: Sequence[MethodRun]) -> Figure:
    """Draw one curve for every run of the iteration: a panel for each order of the modes.

    The LMI is left out. Of a family in blocks, the longest way is drawn.
    """
    drawn = [run for run in runs if run.histories]
    orders = list(dict.fromkeys(run.order for run in drawn if run.order))
    coordinates = list(dict.fromkeys(run.coordinates for run in drawn))
    figure = new_figure(0.9 + 2.1 * len(orders))
    panels = figure.subplots(len(orders), sharex=True, sharey=True, squeeze=False)[:, 0]
    for axes, order in zip(panels, orders, strict=True):
        axes.set_title(TITLES[order], fontsize=10)
        axes.set(xscale="log", yscale="log", ylabel="Largest v [1]")
        for run in drawn:
            if run.order == order:
                look = color(coordinates.index(run.coordinates))
                _draw_history(axes, max(run.histories, key=len), look, str(run.coordinates))
    panels[-1].set_xlabel("Update, the start being 1 [1]")
    legend(figure, panels[0], columns=3)
    return figure


def _draw_history(axes: Axes, history: History, look: str, label: str) -> None:
    """Draw v where it is above zero, and mark how the iteration ended."""
    above = [(1 + updates, v) for updates, v in history if v > 0]
    steps, values = zip(*above, strict=True) if above else ((), ())
    axes.plot(steps, values, color=look, label=label, linewidth=1.0)
    ended = history[-1][1] <= 0
    axes.plot(steps[-1:], values[-1:], "o" if ended else "X", color=look, markersize=7, zorder=3)
