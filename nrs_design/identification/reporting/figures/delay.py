"""Figures of an identified delay."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from nrs_design.identification.reporting.figures.identification import MEASURED
from nrs_design.reporting.style import (
    BLUE,
    INK,
    VERMILLION,
    legend,
    new_axes,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.identification.delay.identify import DelayIdentification

# Samples that are drawn, about where the command changes most.
_DRAWN = 400
# In samples: delays that spread less differ by the arithmetic of the fit only.
_LEAST_SHOWN = 0.01


@styled
def draw_following(found: DelayIdentification) -> Figure:
    """Draw command, measurement and fit over time, where the command changes most."""
    record = found.record
    count = len(record.time)
    middle = int(np.argmax(np.abs(np.gradient(record.sent, record.time))))
    first = min(max(middle - _DRAWN // 4, 0), max(count - _DRAWN, 0))
    pick = slice(first, first + _DRAWN)
    figure = new_figure(4.4)
    above, below = figure.subplots(2, 1, sharex=True)
    above.step(record.time[pick], record.sent[pick], where="post", color=INK, linewidth=1.2)
    above.set_ylabel(record.names[0])
    below.plot(
        record.time[pick], record.seen[pick], ".", color=MEASURED, markersize=4.0, label="data"
    )
    fitted = found.chosen.fitted[pick]
    below.plot(record.time[pick], fitted, color=BLUE, linewidth=1.4, label="fitted")
    below.set_ylabel(record.names[1])
    below.set_xlabel("Time [s]")
    legend(figure, below)
    return figure


@styled
def draw_delay(found: DelayIdentification) -> Figure:
    """Draw the delay in parts of the record, and that of the whole."""
    figure, axes = new_axes(3.2)
    whole = found.samples
    axes.axhspan(whole.low, whole.high, color=BLUE, alpha=0.14, linewidth=0, label="whole record")
    axes.axhline(whole.value, color=BLUE, linewidth=1.2)
    for time, part in found.parts:
        axes.plot([time, time], [part.low, part.high], color=VERMILLION, linewidth=2.0)
        axes.plot(time, part.value, "o", color=VERMILLION, markersize=4.5)
    low, high = axes.get_ylim()
    if high - low < _LEAST_SHOWN:
        axes.set_ylim(whole.value - _LEAST_SHOWN / 2, whole.value + _LEAST_SHOWN / 2)
    axes.set_xlabel("Time [s]")
    axes.set_ylabel("Delay [samples]")
    legend(figure, axes)
    return figure
