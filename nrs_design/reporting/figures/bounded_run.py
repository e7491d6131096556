"""Force, deflection and velocity over time, against limits and certified bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.figures.run import draw_modes, groups_of
from nrs_design.reporting.style import (
    BLUE,
    GREEN,
    MUTED,
    VERMILLION,
    legend,
    new_figure,
    row_labels,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.norms import Array
    from nrs_design.simulation.switched import SwitchedRun

# A bound that is so many times higher than all else would squeeze the run flat.
_HIGHEST = 4.0
_ROWS = 10


@dataclass(frozen=True, eq=False)
class BoundedSignal:
    """One quantity over time."""

    label: str  # With its unit
    values: Array  # Shape (N + 1, r). For every row of it.
    limit: float | None  # Of the spec
    bound: Array | None  # Shape (N + 1,). Certified.
    one_sided: bool = False  # Nothing bounds negative values


@styled
def draw_bounded_run(
    response: SwitchedRun, panels: Sequence[BoundedSignal], names: Sequence[str], unit: str = "s"
) -> Figure:
    """Draw all panels over one time axis, and below them the mode that is active."""
    groups = groups_of(response, names, _ROWS)
    labels, height = row_labels([group.name for group in groups])
    rows = height * len(groups)
    figure = new_figure(1.9 * len(panels) + 0.8 + rows)
    ratios = [*([1.9] * len(panels)), rows]
    *above, below = figure.subplots(len(panels) + 1, 1, sharex=True, height_ratios=ratios)
    for axes, panel in zip(above, panels, strict=True):
        _draw_panel(axes, response.time, panel)
    draw_modes(below, response, groups, labels)
    below.set_xlabel(f"Time [{unit}]")
    legend(figure, above[0], 2)
    return figure


def _draw_panel(axes: Axes, time: Array, panel: BoundedSignal) -> None:
    low, high = panel.values.min(axis=1), panel.values.max(axis=1)
    if panel.values.shape[1] > 1:
        axes.fill_between(time, low, high, color=BLUE, alpha=0.25, label="over the contact's range")
    middle = panel.values[:, np.abs(panel.values).max(axis=0).argmax()]
    axes.plot(time, middle, color=BLUE, label="simulated run")
    axes.axhline(0.0, color=MUTED, linewidth=0.8)
    top = max(float(np.abs(panel.values).max()), panel.limit or 0.0)
    if panel.limit is not None:
        for sign in (1.0, -1.0):
            label = "limit of the spec" if sign > 0 else None
            axes.axhline(sign * panel.limit, color=GREEN, linestyle=":", label=label)
    if panel.bound is not None:
        for sign in (1.0,) if panel.one_sided else (1.0, -1.0):
            label = "certified bound" if sign > 0 else None
            axes.plot(time, sign * panel.bound, color=VERMILLION, linestyle="--", label=label)
        top = max(top, min(float(panel.bound.max()), _HIGHEST * top))
    axes.set(ylim=(-1.08 * top, 1.08 * top), ylabel=panel.label)
