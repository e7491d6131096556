"""Trade-offs between the gains of an admittance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nrs_design.axis import labelled
from nrs_design.design.landscape import CostMap, alternatives, map_cost
from nrs_design.reporting.document import Block, Illustration, Paragraph, Section, Table
from nrs_design.reporting.formatting import number
from nrs_design.reporting.sections.places import linked
from nrs_design.reporting.style import BLUE, GREEN, INK, MUTED, VERMILLION, legend, new_axes, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.design.analysis import ImpedanceAnalysis
    from nrs_design.pipeline.design import Designed
    from nrs_design.spec import LoadedSpec

# More maps are nearly alike.
_DRAWN = 4
_GAINS = ("Mt", "Bt")
_TEXT = (
    "The cost weighs how far the displayed impedance is from the desired one against the mean "
    "sensitivity, up to the bandwidth. Where gains may be chosen, each row of a table is the best "
    "for something else: what it gains there, it gives up in the other columns. The cost is that "
    "of the thesis: its loop G Ze H Y at nominal values, in continuous time and without a load "
    "of the motor. Floating point, goals left out; no part of the proof."
)
_MAP = (
    "Lines of equal cost, with the values of some. Shaded: the loop that is proved is unstable at "
    "its nominal values."
)
_BOX = (
    " The dashed box is where the spec allows the gains to be; an optimum on its edge was chosen "
    "by the bound, not by the cost."
)


def landscape_section(designed: Designed, items: tuple[ImpedanceAnalysis, ...]) -> Section:
    """Show cost and alternatives of the impedance controllers."""
    blocks: list[Block] = [Paragraph(_TEXT)]
    for item in items[:_DRAWN]:
        blocks.append(_map(item))
        # Where nothing may be chosen, nothing else is the best for anything.
        if len(_given(item)) < len(_GAINS):
            blocks.append(_table(designed.loaded, item))
    return Section("What the gains give up", tuple(blocks))


def _map(item: ImpedanceAnalysis) -> Illustration:
    found = map_cost(item.problem, item.requirement, item.Mt, item.Bt)
    remarks = [
        f"{gain} is on its {side} bound."
        for gain in _GAINS
        if not (bounds := getattr(item.given, gain)).fixed
        for side, end in (("lower", bounds.min), ("upper", bounds.max))
        if getattr(item.optimum, gain) == end.si
    ]
    if given := _given(item):
        verb = "is" if len(given) == 1 else "are"
        remarks.append(f"{' and '.join(given)} {verb} given by the spec, not optimized.")
    held = " ".join(remarks)
    return Illustration(
        f"cost-{item.name}",
        f"Cost over Mt and Bt: {item.name}",
        f"{_MAP}{'' if item.given.Mt.fixed or item.given.Bt.fixed else _BOX} {held}".rstrip(),
        draw_cost(item, found),
    )


def _given(item: ImpedanceAnalysis) -> list[str]:
    return [gain for gain in _GAINS if getattr(item.given, gain).fixed]


def _table(loaded: LoadedSpec, item: ImpedanceAnalysis) -> Table:
    at = ("controllers", item.name)
    rows = tuple(
        (
            other.name,
            linked(loaded, number(other.Mt, 4), *at, "Mt"),
            linked(loaded, number(other.Bt, 4), *at, "Bt"),
            # What follows from several lines leads to the controller, which names the others.
            *(
                linked(loaded, text, *at)
                for text in (
                    number(other.cost, 4),
                    number(other.displayed, 3),
                    number(other.sensitivity, 3),
                )
            ),
        )
        for other in alternatives(item.problem, item.Mt, item.Bt)
    )
    columns = (
        "Gains",
        labelled("Mt [kg·m²]"),
        labelled("Bt [N·m·s/rad]"),
        "Cost [1]",
        "Off the desired impedance, mean [decades]",
        "Mean sensitivity [1]",
    )
    return Table(f"What is given up: {item.name}", columns, rows)


_LEVELS, _UP_TO = 8, 0.9


@styled
def draw_cost(item: ImpedanceAnalysis, found: CostMap) -> Figure:
    """Draw lines of equal cost, the border of stability, the bounds and the gains."""
    figure, axes = new_axes(4.2)
    axes.set(xscale="log", yscale="log")
    _draw_levels(axes, found)
    _draw_border(axes, found)
    _draw_bounds(axes, item, found)
    points = [(item.Mt, item.Bt, "D", 4.5, INK, "as shipped")]
    if not (item.given.Mt.fixed and item.given.Bt.fixed):
        best = "optimum within bounds and goals"
        points.insert(0, (item.optimum.Mt, item.optimum.Bt, "*", 15.0, GREEN, best))
    for Mt, Bt, shape, size, tint, label in points:
        # No mass at all is drawn at the left edge.
        place = max(Mt, float(found.Mt[0]))
        axes.plot(place, Bt, shape, markersize=size, color=tint, mec=INK, ls="none", label=label)
    axes.set(
        xlabel=labelled("Virtual mass Mt [kg·m²]"),
        ylabel=labelled("Virtual damping Bt [N·m·s/rad]"),
        xlim=(found.Mt[0], found.Mt[-1]),
        ylim=(found.Bt[0], found.Bt[-1]),
    )
    legend(figure, axes, 2)
    return figure


def _draw_levels(axes: Axes, found: CostMap) -> None:
    """Draw lines of equal cost, with the values of some."""
    finite = found.cost[np.isfinite(found.cost)]
    if not len(finite) or np.quantile(finite, _UP_TO) <= finite.min():
        return
    # Denser near the minimum; levels end below the peaks at the stability border.
    span = float(np.quantile(finite, _UP_TO)) - finite.min()
    levels = finite.min() + span * np.linspace(0, 1, _LEVELS + 1)[1:] ** 2
    lines = axes.contour(found.Mt, found.Bt, found.cost, levels=levels, colors=BLUE, linewidths=0.9)
    axes.plot([], [], color=BLUE, linewidth=0.9, label="equal cost")
    axes.clabel(lines, levels[3::2].tolist(), fmt="%.3g", fontsize=9, colors=INK)


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
