"""What a little more cost buys, as a figure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from nrs_design.axis import unit
from nrs_design.design.objective import Objective
from nrs_design.reporting.style import color, legend, marker, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.pipeline.trade_off import TradeOffCurve, TradeOffPoint


@styled
def draw_trade_off(curves: Sequence[TradeOffCurve], objective: Objective) -> Figure:
    """Draw every proved point, and ring those of the least cost.

    Parameters
    ----------
    curves : sequence of TradeOffCurve
        Without virtual masses, and with them.
    objective : Objective
        What was to be large: of several contacts, the stiffness of the first is drawn.
    """
    figure, axes = new_axes()
    for index, curve in enumerate(curves):
        points = [(point.cost, _value(point, objective)) for point in curve.points]
        costs, values = zip(*points, strict=True) if points else ((), ())
        look = color(index)
        label = "No virtual mass" if curve.massless else "With virtual mass"
        # Nothing is proved between the points.
        axes.plot(costs, values, ":", marker=marker(index), color=look, label=label, linewidth=1.0)
        free = [(point.cost, _value(point, objective)) for point in curve.points[:1]]
        for cost, value in free:
            axes.plot([cost], [value], "o", color=look, markersize=13, fillstyle="none")
    axes.set_xlabel("Cost of all controllers [1], the least one ringed")
    if objective is Objective.STIFFNESS:
        axes.set_ylabel(f"Stiffness proved up to [{unit('N m/rad')}]")
    else:
        axes.set_ylabel("Decay rate proved [1/s]")
    legend(figure, axes)
    return figure


def _value(point: TradeOffPoint, objective: Objective) -> float:
    if objective is Objective.STIFFNESS:
        return float(next(iter(point.stiffness.values())))
    return float(point.rate)
