"""Figures of identifications and runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nrs_design.identification.numeric import Array, Complex, Flags
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
    kept = np.ones(len(time), bool)[pick] if used is None else used[pick]
    figure = new_figure(4.4)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1.0])
    t, data, curve = time[pick], measured[pick], fitted[pick]
    above.plot(t[kept], data[kept], ".", color=_MEASURED, markersize=4.0, label="data")
    if not kept.all():
        above.plot(t[~kept], data[~kept], "x", color=_UNUSED, markersize=3.5, label="not used")
    above.plot(t, np.where(kept, curve, np.nan), color=BLUE, label="fitted", linewidth=1.4)
    above.set_ylabel(label)
    below.plot(t[kept], (data - curve)[kept], ".", color=VERMILLION, markersize=2.5)
    below.axhline(0.0, color=INK, linewidth=0.8)
    # Short enough for its height.
    below.set_ylabel("Data - fitted")
    below.set_xlabel("Time [s]")
    legend(figure, above)
    return figure


@styled
def draw_response(frequency: Array, measured: Complex, model: tuple[Array, Complex]) -> Figure:
    """Draw magnitude and phase of data and model over frequencies in rad/s."""
    figure = new_figure(4.8)
    above, below = figure.subplots(2, 1, sharex=True)
    for w, values, style, color, label in (
        (frequency, measured, "o", VERMILLION, "data"),
        (*model, "-", BLUE, "fitted"),
    ):
        decibel = 20 * np.log10(np.abs(values))
        above.semilogx(w, decibel, style, color=color, label=label)
        below.semilogx(w, np.degrees(np.angle(values)), style, color=color)
    above.set_ylabel("Magnitude [dB]")
    below.set_ylabel("Phase [deg]")
    below.set_xlabel("Frequency [rad/s]")
    legend(figure, above)
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
