"""Figures of identifications and runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nrs_design.identification.numeric import Array, Flags
from nrs_design.reporting.style import (
    ALARM,
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    legend,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.identification.running.judge import RunJudgement

# Most points of a curve on a page.
_POINTS = 1500
_MEASURED = "#7d8894"
_UNUSED = "#d9b7a0"
# Columns of a run, from the top.
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
def draw_fit(
    time: Array, measured: Array, fitted: Array, label: str, used: Flags | None = None
) -> Figure:
    """Draw a measured and a fitted output over time in s, and their difference below.

    Samples that were not used for the fit are pale.
    """
    pick = _thinned(len(time))
    shown = np.ones(len(time), bool)[pick] if used is None else used[pick]
    figure = new_figure(4.4)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1.0])
    t, data, curve = time[pick], measured[pick], fitted[pick]
    upper.plot(t[shown], data[shown], ".", color=_MEASURED, markersize=4.0, label="data")
    if not shown.all():
        upper.plot(t[~shown], data[~shown], "x", color=_UNUSED, markersize=3.5, label="not used")
    upper.plot(t, np.where(shown, curve, np.nan), color=BLUE, label="fitted", linewidth=1.4)
    upper.set_ylabel(label)
    lower.plot(t[shown], (data - curve)[shown], ".", color=VERMILLION, markersize=2.5)
    lower.axhline(0.0, color=INK, linewidth=0.8)
    # Short enough for its height.
    lower.set_ylabel("Data - fitted")
    lower.set_xlabel("Time [s]")
    legend(figure, upper)
    return figure


@styled
def draw_log(run: RunJudgement) -> Figure:
    """Draw every column of a log over time."""
    log, first = run.log, run.first
    names = [name for name in _LABELS if name in log.columns]
    figure = new_figure(0.8 + 1.15 * len(names))
    rows = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
    pick = _thinned(len(log.time))
    for axes, name in zip(rows, names, strict=True):
        values = log.columns[name][pick]
        axes.step(log.begin + log.time[pick], values, where="post", color=INK, linewidth=1.0)
        label = _LABELS[name] + (f" [{log.command_unit}]" if name == "command" else "")
        axes.set_ylabel(label, fontsize=8.5)
        if name == "mode":
            axes.set_yticks(range(len(log.labels)), log.labels)
        if name == "torque":
            for sign in (-1, 1):
                axes.axhline(sign * run.bounds.torque, color=MUTED, linestyle=":", linewidth=1)
        if first is not None and first.first is not None:
            axes.axvline(first.first.time, color=ALARM, linestyle="--", linewidth=1.2)
    rows[-1].set_xlabel("Time [s]")
    return figure


def _thinned(count: int) -> slice:
    """Return which of many points are drawn."""
    return slice(None, None, max(1, -(-count // _POINTS)))
