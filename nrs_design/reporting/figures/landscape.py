"""The cost over both gains of an admittance, and the dead time that it bears over stiffness."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.design.landscape import CostMap, delay_borne
from nrs_design.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    VERMILLION,
    color,
    curve,
    legend,
    new_axes,
    settle,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from matplotlib.transforms import BboxBase

    from nrs_design.design.analysis import ImpedanceAnalysis

_LEVELS, _UP_TO, _POINTS = 8, 0.9, 160
# Between labels, over their size.
_ROOM = (1.2, 1.4)
# Beyond so many times the dead time at the stiffest contact, a curve is not drawn.
_TALLEST = 20.0


@styled
def draw_cost(item: ImpedanceAnalysis, found: CostMap) -> Figure:
    """Draw lines of equal cost, the border of stability, the bounds and the gains.

    Parameters
    ----------
    item : ImpedanceAnalysis
        The controller.
    found : CostMap
        Around its gains.
    """
    figure, axes = new_axes(4.2)
    axes.set_xscale("log")
    axes.set_yscale("log")
    labels = _draw_levels(axes, found)
    _draw_border(axes, found)
    _draw_bounds(axes, item, found)
    points = [(item.Mt, item.Bt, "D", 4.5, INK, "as shipped")]
    # Gains that the spec gives are no optimum.
    if not (item.given.Mt.fixed and item.given.Bt.fixed):
        best = "optimum within bounds and goals"
        points.insert(0, (item.optimum.Mt, item.optimum.Bt, "*", 15.0, GREEN, best))
    for Mt, Bt, shape, size, tint, label in points:
        # No mass at all is drawn at the left edge.
        place = max(Mt, float(found.Mt[0]))
        axes.plot(place, Bt, shape, markersize=size, color=tint, mec=INK, ls="none", label=label)
    axes.set_xlabel("Virtual mass Mt [kg·m²]")
    axes.set_ylabel("Virtual damping Bt [N·m·s/rad]")
    axes.set_xlim(found.Mt[0], found.Mt[-1])
    axes.set_ylim(found.Bt[0], found.Bt[-1])
    legend(figure, axes, 2)
    settle(figure)
    _keep_apart(labels)
    return figure


def _draw_levels(axes: Axes, found: CostMap) -> list[Text]:
    """Draw lines of equal cost; return the labels of some."""
    finite = found.cost[np.isfinite(found.cost)]
    if not len(finite) or np.quantile(finite, _UP_TO) <= finite.min():
        return []
    # Closer together near the least cost, where the choice is made; not up to peaks at the border.
    span = float(np.quantile(finite, _UP_TO)) - finite.min()
    levels = finite.min() + span * np.linspace(0, 1, _LEVELS + 1)[1:] ** 2
    lines = axes.contour(found.Mt, found.Bt, found.cost, levels=levels, colors=BLUE, linewidths=0.9)
    axes.plot([], [], color=BLUE, linewidth=0.9, label="equal cost")
    return list(axes.clabel(lines, levels[1::2].tolist(), fmt="%.3g", fontsize=9, colors=INK))


def _keep_apart(labels: Iterable[Text]) -> None:
    """Drop the labels that would lie on another one, where the layout has put them."""
    kept: list[BboxBase] = []
    for label in labels:
        box = label.get_window_extent().expanded(*_ROOM)
        if any(box.overlaps(other) for other in kept):
            label.remove()
        else:
            kept.append(box)


def _draw_border(axes: Axes, found: CostMap) -> None:
    fastest = float(found.abscissa.max())
    if not float(found.abscissa.min()) < 0 < fastest:
        return
    grid = (found.Mt, found.Bt, found.abscissa)
    axes.contourf(*grid, levels=[0.0, fastest], colors=[VERMILLION], alpha=0.15)
    axes.contour(*grid, levels=[0.0], colors=VERMILLION, linewidths=2.0)
    axes.plot(
        [], [], color=VERMILLION, linewidth=2.0, label="border of stability (unstable: shaded)"
    )


def _draw_bounds(axes: Axes, item: ImpedanceAnalysis, found: CostMap) -> None:
    (left, right), (low, high) = item.problem.mass_bounds, item.problem.damping_bounds
    left = max(left, float(found.Mt[0]))
    if left < right and low < high:
        x, y = [left, right, right, left, left], [low, low, high, high, low]
        axes.plot(x, y, color=MUTED, linestyle="--", linewidth=1.2, label="bounds of the spec")


@styled
def draw_delay_borne(items: Sequence[ImpedanceAnalysis], sampled: float | None) -> Figure:
    """Draw the delay margin over the stiffness of the contact.

    Parameters
    ----------
    items : sequence of ImpedanceAnalysis
        A curve for each.
    sampled : float or None
        Age of the oldest force sample in s that the spec declares; None draws none.
    """
    figure, axes = new_axes(3.6)
    nominal = [item.problem.loop.contact.stiffness for item in items]
    highest = max(item.highest_stiffness for item in items)
    stiffness = np.geomspace(min(nominal) / 10, 10 * highest, _POINTS)
    shown = []
    for index, item in enumerate(items):
        borne = 1e3 * delay_borne(item.requirement, item.Mt, item.Bt, stiffness)
        borne = np.where(np.isfinite(borne), borne, np.nan)
        shown.append(float(np.interp(item.highest_stiffness, stiffness, np.nan_to_num(borne))))
        axes.plot(stiffness, borne, label=item.name, **curve(index, len(items), len(stiffness)))
        axes.axvline(item.highest_stiffness, color=color(index), linewidth=0.9, linestyle=":")
    if sampled:
        label = "oldest force sample of the spec"
        axes.axhline(1e3 * sampled, color=MUTED, linestyle="--", label=label)
    axes.set_xscale("log")
    axes.set_ylim(0, _TALLEST / 4 * max(*shown, 1e-3) + 1e3 * (sampled or 0))
    axes.set_xlim(stiffness[0], stiffness[-1])
    axes.set_xlabel("Stiffness of the contact [N·m/rad]")
    axes.set_ylabel("Dead time that destabilizes [ms]")
    legend(figure, axes)
    return figure
