"""Figures of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.identification.reporting.figures.identification import thinned
from nrs_design.reporting.style import (
    ALARM,
    BLUE,
    INK,
    MUTED,
    new_axes,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.identification.running.judge import RunJudgement

_LABELS = {
    "angle": "Angle [rad]",
    "torque": "Torque [N m]",
    "deflection": "Deflection [m]",
    "force": "Force [N]",
    "velocity": "Velocity [rad/s]",
    "command": "Command",
    "mode": "Mode",
}


@styled
def draw_stiffness(found: RunJudgement) -> Figure:
    """Draw the slope in every window over time, and the ranges of the spec."""
    log = found.log
    figure, axes = new_axes(3.6)
    ranges = found.bounds.ranges_of(found.bounds.stiffness)
    top = 1.8 * max((high for _, high in ranges), default=1.0)
    bottom = -0.2 * top
    for low, high in ranges:
        axes.axhspan(low, high, color=BLUE, alpha=0.14, linewidth=0)
    for w in found.windows:
        middle = log.begin + float(log.time[w.first : w.last].mean())
        axes.plot([middle, middle], [max(w.low, bottom), min(w.high, top)], color=BLUE)
        axes.plot(middle, min(max(w.value, bottom), top), "o", color=BLUE, markersize=4)
    axes.set_ylim(bottom, top)
    axes.set_xlim(log.begin, log.begin + float(log.time[-1]))
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Slope at the pivot [N m/rad]")
    _mark(found, axes)
    return figure


@styled
def draw_judgement(found: RunJudgement) -> Figure:
    """Draw every column of the log over time."""
    log = found.log
    names = [name for name in _LABELS if name in log.columns]
    figure = new_figure(0.8 + 1.15 * len(names))
    rows = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    pick = thinned(len(log.time))
    for axes, name in zip(rows, names, strict=True):
        values = log.columns[name][pick]
        axes.step(log.begin + log.time[pick], values, where="post", color=INK, linewidth=1.0)
        label = _LABELS[name] + (f" [{log.command_unit}]" if name == "command" else "")
        axes.set_ylabel(label, fontsize=8.5)
        if name == "mode":
            axes.set_yticks(range(len(log.labels)), log.labels)
        if name == "torque":
            for sign in (-1, 1):
                axes.axhline(sign * found.bounds.torque, color=MUTED, linestyle=":", linewidth=1)
        _mark(found, axes)
    rows[-1].set_xlabel("Time [s]")
    return figure


def _mark(found: RunJudgement, axes: Axes) -> None:
    first = found.first
    if first is not None and first.first is not None:
        axes.axvline(first.first.time, color=ALARM, linestyle="--", linewidth=1.2)
