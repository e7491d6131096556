"""The common quadratic function: its matrix, and how fast it decreases in every mode."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.reporting.style import (
    BLUE,
    INK,
    VERMILLION,
    legend,
    new_axes,
    short,
    styled,
)
from nrs_design.switched.system import Time

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from nrs_design.simulation.switched import Array

_WRITTEN = 8


@styled
def draw_quadratic(Q: Array, states: Sequence[str]) -> Figure:
    """Draw Q as a heat map, scaled so that its diagonal is one.

    Parameters
    ----------
    Q : ndarray, shape (n, n)
        Positive definite.
    states : sequence of str
        Names with units; more than eight are numbered instead.
    """
    n = len(Q)
    diagonal = np.sqrt(np.diag(Q))
    scaled = Q / np.outer(diagonal, diagonal)
    figure, axes = new_axes(2.6 + 0.2 * min(n, _WRITTEN))
    image = axes.imshow(scaled, cmap="PuOr", vmin=-1, vmax=1, aspect="auto")
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    if n <= _WRITTEN:
        labels = [short(name, 14) for name in states]
        axes.set_xticks(range(n), labels, rotation=0 if n <= 4 else 35)
        axes.set_yticks(range(n), labels)
        for (i, j), value in np.ndenumerate(scaled):
            tint = "white" if abs(value) > 0.7 else INK
            axes.text(j, i, f"{value:.2f}", ha="center", va="center", color=tint, fontsize=9)
    axes.set_xlabel("State j")
    axes.set_ylabel("State i")
    figure.colorbar(image, ax=axes, label="Scaled entry of Q [1]")
    return figure


@styled
def draw_mode_rates(names: Sequence[str], rates: Array, claimed: float, time: Time) -> Figure:
    """Draw every mode's own rate in the norm of Q beside the claimed one.

    Parameters
    ----------
    names : sequence of str
        Of the modes shown.
    rates : ndarray, shape (m,)
        Decay rates in 1/s, or contractions per step.
    claimed : float
        What the certificate claims for all.
    time : Time
        Continuous or discrete.
    """
    continuous = time is Time.CONTINUOUS
    figure, axes = new_axes(1.5 + 0.27 * len(names))
    rows = np.arange(len(names))
    axes.plot(rates, rows, "o", color=BLUE, label="this mode alone")
    label = f"claimed for all: {claimed:.6g}" + (" 1/s" if continuous else "")
    axes.axvline(claimed, color=VERMILLION, linestyle="--", label=label)
    axes.set_yticks(rows, [short(name) for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    low, high = min(float(rates.min()), claimed), max(float(rates.max()), claimed)
    room = 0.08 * (high - low) or 0.1 * abs(high)
    axes.set_xlim(low - room, high + room)
    quantity = "Decay rate in the norm of Q [1/s]" if continuous else "Contraction per step [1]"
    axes.locator_params(axis="x", nbins=5)
    axes.set_xlabel(quantity)
    axes.set_ylabel("Mode")
    legend(figure, axes)
    return figure
