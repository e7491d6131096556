"""Figures of an identification: measured against fitted."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.identification.numeric import Array, Complex, Flags
from nrs_design.reporting.style import (
    BLUE,
    INK,
    MUTED,
    VERMILLION,
    legend,
    new_axes,
    new_figure,
    row_labels,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.identification.actuator.identify import ActuatorIdentification
    from nrs_design.identification.statistics import Estimate


# More points than these cannot be told apart on a page.
_POINTS = 1500
MEASURED = "#7d8894"
_UNUSED = "#d9b7a0"


@styled
def draw_fit(
    time: Array,
    measured: Array,
    fitted: Array,
    label: str,
    used: Flags | None = None,
) -> Figure:
    """Draw a measured and a fitted output over time in s, and their difference below.

    Samples that were not used for the fit are pale.
    """
    pick = thinned(len(time))
    kept = np.ones(len(time), bool)[pick] if used is None else used[pick]
    figure = new_figure(4.4)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.4, 1.0])
    t, data, curve = time[pick], measured[pick], fitted[pick]
    above.plot(t[kept], data[kept], ".", color=MEASURED, markersize=4.0, label="data")
    if not kept.all():
        above.plot(t[~kept], data[~kept], "x", color=_UNUSED, markersize=3.5, label="not used")
    above.plot(t, np.where(kept, curve, np.nan), color=BLUE, label="fitted", linewidth=1.4)
    above.set_ylabel(label)
    below.plot(t[kept], (data - curve)[kept], ".", color=VERMILLION, markersize=2.5)
    below.axhline(0.0, color=INK, linewidth=0.8)
    # Short enough for its height; the unit is that of the record.
    below.set_ylabel(f"Data - fitted\n{label[label.find('[') :]}")
    below.set_xlabel("Time [s]")
    legend(figure, above)
    return figure


@styled
def draw_loop(deflection: Array, measured: Array, fitted: Array, labels: tuple[str, str]) -> Figure:
    """Draw force over deflection, whose area is the energy that the tissue takes."""
    pick = thinned(len(deflection))
    figure, axes = new_axes(3.9)
    axes.plot(deflection[pick], measured[pick], ".", color=MEASURED, markersize=4.0, label="data")
    axes.plot(deflection[pick], fitted[pick], color=BLUE, label="fitted", linewidth=1.4)
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    legend(figure, axes)
    return figure


@styled
def draw_intervals(
    names: Sequence[str],
    single: Sequence[Estimate],
    pooled: Estimate,
    wide: Estimate,
    label: str,
) -> Figure:
    """Draw one parameter: its interval in each record, pooled, and the range over all records."""
    labels, height = row_labels([*names, "pooled"])
    figure, axes = new_axes(1.1 + height * len(labels))
    label_of_all = "range over all records"
    axes.axvspan(wide.low, wide.high, color=BLUE, alpha=0.14, linewidth=0, label=label_of_all)
    for row, estimate in enumerate([*single, pooled]):
        tint, shape = (INK, "D") if row == len(single) else (BLUE, "o")
        axes.plot([estimate.low, estimate.high], [row, row], color=tint, linewidth=2.0)
        axes.plot(estimate.value, row, shape, color=tint, markersize=5)
    axes.set_yticks(range(len(labels)), labels, fontsize=9)
    axes.set_ylim(len(names) + 0.6, -0.6)
    axes.set_xlabel(f"{label}\n95 % intervals; shaded: range over all records")
    axes.grid(visible=False, axis="y")
    return figure


@styled
def draw_bode(found: ActuatorIdentification) -> Figure:
    """Draw magnitude and phase of velocity over command, data and fit."""
    figure = new_figure(4.8)
    above, below = figure.subplots(2, 1, sharex=True)
    w = found.frequency
    fine = np.geomspace(w.min() / 1.5, w.max() * 1.5, 200)
    model = found.chosen.response(fine)
    above.semilogx(w, _decibel(found.response), "o", color=VERMILLION, label="data", zorder=3)
    above.semilogx(fine, _decibel(model), color=BLUE, label="fitted")
    below.semilogx(w, np.degrees(np.angle(found.response)), "o", color=VERMILLION, zorder=3)
    below.semilogx(fine, np.degrees(np.angle(model)), color=BLUE)
    corner = 1 / found.chosen.time_constant.value
    for axes in (above, below):
        axes.axvline(corner, color=MUTED, linestyle="--", linewidth=1.0)
    above.annotate(
        f"1/τ = {corner:.4g} rad/s",
        (corner, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(5, -12),
        textcoords="offset points",
        fontsize=9,
        color=MUTED,
    )
    above.set_ylabel("Magnitude [dB]")
    below.set_ylabel("Phase [deg]")
    below.set_xlabel("Frequency [rad/s]")
    legend(figure, above)
    return figure


def _decibel(values: Complex) -> Array:
    return np.asarray(20 * np.log10(np.abs(values)))


def thinned(count: int) -> slice:
    """Return which of many points are drawn."""
    return slice(None, None, max(1, -(-count // _POINTS)))
