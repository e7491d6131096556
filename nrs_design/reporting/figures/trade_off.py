"""What a little more cost buys, as a figure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from nrs_design.axis import unit
from nrs_design.design.objective import Objective
from nrs_design.reporting.style import color, legend, marker, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.pipeline.trade_off import TradeOffCurve
    from nrs_design.pipeline.trade_point import TradeOffPoint

HEIGHT, LEGEND = 2.6, 1.0
# What an axis is about, its unit, and the factor from SI units.
AXES = {
    Objective.STIFFNESS: ("Stiffness proved up to", "N m/rad", 1.0),
    Objective.DECAY_RATE: ("Decay rate proved", "1/s", 1.0),
    Objective.DELAY: ("Delay proved up to", "ms", 1e3),
    Objective.PEAK_TORQUE: ("Force proved below", "N m", 1.0),
    Objective.NOISE: ("Noise in velocity", "rad/(s N m)", 1.0),
}


@styled
def draw_trade_off(
    curves: Sequence[TradeOffCurve],
    given: Mapping[str, TradeOffPoint | None],
    objectives: Sequence[Objective],
) -> Figure:
    """Draw every proved point over its cost, and ring those of the least cost.

    Parameters
    ----------
    curves : sequence of TradeOffCurve
        For each objective without virtual masses, and with them.
    given : mapping
        Designs to be drawn in, by name; None where nothing is proved.
    objectives : sequence of Objective
        A panel for each; of several contacts, the stiffness of the first is drawn.
    """
    figure = new_figure(LEGEND + HEIGHT * len(objectives))
    panels = figure.subplots(len(objectives), 1, sharex=True, squeeze=False)[:, 0]
    for axes, objective in zip(panels, objectives, strict=True):
        own = [curve for curve in curves if curve.objective is objective]
        _draw(axes, objective, own, given)
    panels[-1].set_xlabel("Cost of all controllers [1], the least one ringed")
    legend(figure, panels[0])
    return figure


def _draw(
    axes: Axes,
    objective: Objective,
    curves: Sequence[TradeOffCurve],
    given: Mapping[str, TradeOffPoint | None],
) -> None:
    """Draw the panel of one objective."""
    title, written, factor = AXES[objective]

    def place(point: TradeOffPoint) -> tuple[float, float]:
        return point.cost, factor * (point.value(objective) or 0.0)

    for index, curve in enumerate(curves):
        points = [place(point) for point in curve.points]
        look = color(index)
        label = "No virtual mass" if curve.massless else "With virtual mass"
        # Nothing is proved between the points.
        axes.plot(
            [cost for cost, _ in points],
            [value for _, value in points],
            ":",
            marker=marker(index),
            color=look,
            label=label,
            linewidth=1.0,
        )
        for point in curve.points[:1]:
            if point.share is None:
                cost, value = place(point)
                axes.plot([cost], [value], "o", color=look, markersize=13, fillstyle="none")
    for index, (name, beside) in enumerate(given.items(), start=len(curves)):
        if beside is not None and beside.value(objective) is not None:
            cost, value = place(beside)
            axes.plot([cost], [value], "*", color=color(index), markersize=11, label=name)
    axes.set_ylabel(f"{title} [{unit(written)}]")
