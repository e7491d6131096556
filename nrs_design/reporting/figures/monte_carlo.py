"""How the peaks of many runs are spread, with limits and certified bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.proof.bounds import upper
from nrs_design.reporting.style import BLUE, GREEN, VERMILLION, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from nrs_design.simulation.norms import Array

# A limit or bound that is so many times farther than the largest peak is named, not drawn.
_FAR = 1.5
_BINS = 40
# The axis reaches so far to both sides at least, as a part of what it shows.
_NARROW = 0.02
# Lines are seen in front of the bars.
_PALE = 0.45


@dataclass(frozen=True, eq=False)
class Spread:
    """The peaks of one quantity."""

    label: str  # With its unit
    peaks: Array  # Shape (N,). One for each run.
    limits: tuple[float, ...]  # Of the scenarios; equal ones once
    bound: float | None  # Certified
    holds: bool  # Whether the bound is about these runs


@styled
def draw_monte_carlo(spreads: Sequence[Spread]) -> Figure:
    """Draw a histogram of every quantity.

    Parameters
    ----------
    spreads : sequence of Spread
        At least one.
    """
    figure = new_figure(2.1 * len(spreads) + 0.6)
    rows: Sequence[Axes] = figure.subplots(len(spreads), 1, squeeze=False)[:, 0].tolist()
    for axes, spread in zip(rows, spreads, strict=True):
        _draw(axes, spread)
    _legend(figure, spreads)
    return figure


def _draw(axes: Axes, spread: Spread) -> None:
    largest = float(spread.peaks.max())
    lines = [(limit, "limit", GREEN, ":") for limit in spread.limits]
    if spread.bound is not None:
        lines.append((spread.bound, _bound_name(holds=spread.holds), VERMILLION, "--"))
    far = [line for line in lines if line[0] > _FAR * largest]
    near = max([largest, *(line[0] for line in lines if line not in far)])
    low = min(float(spread.peaks.min()), near)
    # Peaks that differ in their last digits alone are at one place, with ticks that can be read.
    margin = max(0.04 * (near - low), _NARROW * near - (near - low) / 2) or 1.0
    edges = np.linspace(low - margin, near + margin, _BINS + 1).tolist()
    axes.hist(spread.peaks, bins=edges, color=BLUE, alpha=_PALE)
    for line in lines:
        if line not in far:
            axes.axvline(line[0], color=line[2], linestyle=line[3], lw=2.0)
    if far:
        named = ", ".join(f"{name} {_far_value(name, value)}" for value, name, *_ in far)
        axes.set_title(f"beyond this scale: {named}", fontsize=9, loc="right")
    axes.set_xlabel(spread.label)
    axes.set_ylabel("Runs")
    axes.locator_params(axis="y", integer=True)


def _far_value(name: str, value: float) -> str:
    """Write a bound rounded upward, but a limit as the spec has it: 3.6 is not 3.601."""
    return f"{value:.6g}" if name == "limit" else upper(Fraction(value), 4)


def _bound_name(*, holds: bool) -> str:
    return "certified bound" if holds else "bound, not about all runs"


def _legend(figure: Figure, spreads: Sequence[Spread]) -> None:
    from nrs_design.plotting import Line2D, Patch

    handles: list[Line2D | Patch] = [
        Patch(facecolor=BLUE, alpha=_PALE, label="peaks of the runs"),
        Line2D([], [], color=GREEN, linestyle=":", lw=1.6, label="limit"),
    ]
    if any(spread.bound is not None for spread in spreads):
        label = _bound_name(holds=all(s.holds for s in spreads if s.bound is not None))
        handles.append(Line2D([], [], color=VERMILLION, linestyle="--", lw=1.6, label=label))
    figure.legend(handles=handles, loc="outside lower center", ncols=3)
