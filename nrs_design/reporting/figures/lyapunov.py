"""Lyapunov functions: their matrices, and how fast they decrease in every mode."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.evidence.fields import rate_words
from nrs_design.proof.mode import Time
from nrs_design.reporting.style import (
    BLUE,
    INK,
    VERMILLION,
    curve,
    legend,
    new_axes,
    new_figure,
    row_labels,
    styled,
)
from nrs_design.reporting.text import wrapped_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

    from nrs_design.simulation.norms import Array

_WRITTEN, _WRITTEN_SMALL = 8, 3


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
    figure, axes = new_axes(2.6 + 0.2 * min(n, _WRITTEN))
    image = _heat_map(axes, Q, written=n <= _WRITTEN)
    if n <= _WRITTEN:
        labels = [wrapped_label(name, 14) for name in states]
        axes.set_xticks(range(n), labels, rotation=0 if n <= 4 else 60)
        axes.set_yticks(range(n), labels)
    axes.set_xlabel("State j")
    axes.set_ylabel("State i")
    figure.colorbar(image, ax=axes, label="Scaled entry of Q [1]")
    return figure


@styled
def draw_quadratics(functions: Mapping[str, Array], states: Sequence[str]) -> Figure:
    """Draw several matrices side by side, each scaled so that its diagonal is one.

    Parameters
    ----------
    functions : mapping
        Positive definite matrices by the name of their mode, perhaps of different sizes.
    states : sequence of str
        Names with units; they are numbered in the figure.
    """
    columns = min(len(functions), 3)
    rows = -(-len(functions) // columns)
    figure = new_figure(0.8 + 2.1 * rows)
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes in grid.flat[len(functions) :]:
        axes.set_visible(False)
    for axes, (name, Q) in zip(grid.flat, functions.items(), strict=False):
        n = len(Q)
        image = _heat_map(axes, Q, written=n <= _WRITTEN_SMALL)
        numbers = [str(i + 1) for i in range(n)] if n <= 2 * _WRITTEN else []
        axes.set_xticks(range(len(numbers)), numbers)
        axes.set_yticks(range(len(numbers)), numbers)
        axes.set_title(wrapped_label(name, 18), fontsize=9)
    for axes in grid[:, 0]:
        axes.set_ylabel("State i")
    for column, axes in enumerate(grid[-1]):
        lowest = axes if axes.get_visible() else grid[-2, column]
        lowest.set_xlabel("State j")
    figure.colorbar(image, ax=grid, label="Scaled entry of Q [1]")
    return figure


@styled
def draw_parameter_rates(
    names: Sequence[str], values: Array, rates: Array, claimed: Fraction
) -> Figure:
    """Draw every mode's decay rate over a constant parameter beside the claimed one.

    Parameters
    ----------
    names : sequence of str
        Of the modes shown.
    values : ndarray, shape (k,)
        From 0 (low end) to 1 (high end).
    rates : ndarray, shape (k, m)
        Decay rates in 1/s.
    claimed : Fraction
        What the certificate claims for all, in 1/s.
    """
    figure, axes = new_axes(3.9)
    for index, name in enumerate(names):
        axes.plot(values, rates[:, index], label=name, **curve(index, len(names), len(values)))
    label = f"claimed for all: {rate_words(claimed, Time.CONTINUOUS)}"
    axes.axhline(float(claimed), color=INK, linestyle="--", linewidth=1.3, label=label)
    axes.set_xlabel("Place in the parameter's range, 0 low end, 1 high end [1]")
    axes.set_ylabel("Decay rate in the norm of Q [1/s]")
    axes.set_xlim(0, 1)
    axes.set_ylim(0, 1.15 * float(rates.max()))
    legend(figure, axes)
    return figure


def _heat_map(axes: Axes, Q: Array, *, written: bool) -> AxesImage:
    diagonal = np.sqrt(np.diag(Q))
    scaled = Q / np.outer(diagonal, diagonal)
    image = axes.imshow(scaled, cmap="PuOr", vmin=-1, vmax=1, aspect="auto")
    axes.grid(visible=False)
    axes.spines[:].set_visible(False)
    if written:
        for (i, j), value in np.ndenumerate(scaled):
            tint = "white" if abs(value) > 0.7 else INK
            axes.text(j, i, f"{value:.2f}", ha="center", va="center", color=tint, fontsize=9)
    return image


@styled
def draw_mode_rates(
    names: Sequence[str], rates: Array, claimed: Fraction, time: Time, norm: str
) -> Figure:
    """Draw every mode's own rate in a norm beside the claimed one.

    Parameters
    ----------
    names : sequence of str
        Of the modes shown.
    rates : ndarray, shape (m,)
        Decay rates in 1/s, or contractions per step.
    claimed : Fraction
        What the certificate claims for all.
    time : Time
        Continuous or discrete.
    norm : str
        Which norm it is, such as ``the norm of Q``.
    """
    continuous = time is Time.CONTINUOUS
    labels, row = row_labels(names)
    figure, axes = new_axes(1.0 + row * len(names))
    rows = np.arange(len(names))
    axes.plot(rates, rows, "o", color=BLUE, label="this mode alone")
    bound, label = float(claimed), f"claimed for all: {rate_words(claimed, time)}"
    axes.axvline(bound, color=VERMILLION, linestyle="--", label=label)
    axes.set_yticks(rows, labels, fontsize=9)
    axes.set_ylim(len(names) - 0.5, -0.5)
    low, high = min(float(rates.min()), bound), max(float(rates.max()), bound)
    room = 0.08 * (high - low) or 0.1 * abs(high)
    axes.set_xlim(low - room, high + room)
    quantity = f"Decay rate in {norm} [1/s]" if continuous else "Contraction per step [1]"
    axes.locator_params(axis="x", nbins=4)
    axes.set_xlabel(quantity)
    axes.set_ylabel("Mode")
    legend(figure, axes)
    return figure
