"""Tracking: the motions that were simulated, and their errors beside those of the robot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import CYCLE, DASHES, INK, color, marker, new_figure, styled
from nrs_design.robot.tracking.experiment import (
    COORDINATE,
    DISPLAY,
    MOTIONS,
    TrackingRecord,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_NAMES = ("φ", "ψ", "d")
_UNITS = ("deg", "deg", "mm")
_POINTS = 1500
# An error of zero has no place on a logarithmic axis: a thousandth of a degree or millimeter.
_FLOOR = 1e-3

Measured = tuple[float, float, float] | None


@styled
def draw_tracking(records: Sequence[TrackingRecord], measured: Sequence[Measured]) -> Figure:
    """Draw wanted and measured motions, and below them the root mean square errors.

    Errors measured on the robot are those of phi and psi in deg and d in mm.
    """
    moved = [name for name in MOTIONS if any(r.experiment.moved == name for r in records)]
    controllers = list(dict.fromkeys(record.controller for record in records))
    figure = new_figure(5.6)
    panels = figure.subplots(2, len(moved), squeeze=False)
    for column, name in enumerate(moved):
        chosen = [
            (record, on_robot)
            for record, on_robot in zip(records, measured, strict=True)
            if record.experiment.moved == name
        ]
        _draw_motion(panels[0, column], [record for record, _ in chosen], controllers)
        _draw_errors(panels[1, column], chosen, controllers)
    panels[1, 0].set_ylabel("RMSE [deg, mm]")
    highest = max(axes.get_ylim()[1] for axes in panels[1])
    for axes in panels[1]:
        axes.set_ylim(_FLOOR, highest)
    _legend(figure, controllers, any(measured))
    return figure


def _draw_motion(axes: Axes, records: Sequence[TrackingRecord], controllers: list[str]) -> None:
    index = COORDINATE[records[0].experiment.moved]
    for record in records:
        experiment = record.experiment
        phase = (record.time - experiment.hold) * experiment.rate / (2 * np.pi)
        shown = np.flatnonzero(phase >= -0.1)
        shown = shown[:: max(1, len(shown) // _POINTS)]
        if record is records[0]:
            wanted = DISPLAY[index] * record.wanted[shown, index]
            axes.plot(phase[shown], wanted, color=INK, linestyle=(0, (1, 2)), zorder=5)
        place = controllers.index(record.controller)
        values = DISPLAY[index] * record.measured[shown, index]
        # Controllers that track well lie on top of each other: the later ones have gaps.
        dashes = DASHES[place % len(DASHES)]
        axes.plot(phase[shown], values, color=color(place), linestyle=dashes, linewidth=1.4)
    axes.set_title(f"{_NAMES[index]} moves", fontsize=10)
    axes.set_xlabel("Periods")
    axes.set_ylabel(f"{_NAMES[index]} [{_UNITS[index]}]")


def _draw_errors(
    axes: Axes, chosen: Sequence[tuple[TrackingRecord, Measured]], controllers: list[str]
) -> None:
    width = 0.8 / len(controllers)
    for record, on_robot in chosen:
        place = controllers.index(record.controller)
        where = np.arange(3) + width * (place - (len(controllers) - 1) / 2)
        heights = np.maximum(record.rmse * DISPLAY, _FLOOR)
        axes.bar(where, heights, 0.9 * width, color=CYCLE[place])
        if on_robot is not None:
            axes.plot(where, on_robot, marker(3), color=INK, markersize=4.5)
    axes.set_yscale("log")
    axes.set_xticks(np.arange(3), _NAMES)
    axes.grid(visible=False, axis="x")


def _legend(figure: Figure, controllers: list[str], on_robot: bool) -> None:
    from nrs_design.plotting import Line2D, Patch

    handles: list[Line2D | Patch] = [
        Patch(color=color(place), label=f"{name}, simulated")
        for place, name in enumerate(controllers)
    ]
    handles.append(Line2D([], [], color=INK, linestyle=(0, (1, 2)), label="wanted"))
    if on_robot:
        handles.append(
            Line2D([], [], color=INK, marker=marker(3), ls="none", ms=4.5, label="on the robot")
        )
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
