"""Signals over time in panels, one column for each run; who is in control is shaded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.reporting.style import (
    BLUE,
    GREEN,
    INK,
    MUTED,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

# Two points from each of so many parts of a curve are drawn: its least and its largest value.
_PARTS = 400
_LOOKS: tuple[dict[str, Any], ...] = (
    {"color": BLUE, "lw": 1.6},
    {"color": VERMILLION, "lw": 1.4, "linestyle": (0, (5, 2))},
    {"color": PURPLE, "lw": 1.4, "linestyle": (0, (2, 1.5))},
    {"color": INK, "lw": 1.2, "linestyle": (0, (6, 2, 1.5, 2))},
    {"color": SKY, "lw": 1.6},
    {"color": ORANGE, "lw": 1.4, "linestyle": (0, (5, 2))},
)
_PRINTED: dict[str, Any] = {
    "color": INK,
    "linestyle": "none",
    "marker": "x",
    "markersize": 7,
    "mew": 1.8,
}
_LIMIT: dict[str, Any] = {"color": GREEN, "linestyle": ":", "lw": 1.5}
_BOUND: dict[str, Any] = {"color": VERMILLION, "linestyle": "--", "lw": 1.4}
_INSTANT: dict[str, Any] = {"color": MUTED, "linestyle": (0, (1, 2)), "lw": 1.2}
# Pale, so that a page's light or dark shows through.
_SHADES, _PALE = (SKY, ORANGE, GREEN, PURPLE, BLUE, VERMILLION), 0.16
# Width of all panels in letters; a stay that is narrower than its name goes without.
_LETTERS = 56


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One signal."""

    # t, y: shape (N,). In s, and in the unit of the panel.
    t: NDArray[np.float64]
    y: NDArray[np.float64]
    label: str  # For the legend
    look: int = 0  # Which colour and dashes
    # Whether these are numbers that a publication prints: crosses, not a line.
    printed: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """Axes with signals."""

    label: str  # Quantity and unit
    curves: tuple[Curve, ...]  # Signals
    limits: tuple[float, ...] = ()  # Horizontal lines
    limit: str = "limit"  # What they are
    ticks: tuple[float, ...] = ()  # Where the axis has numbers; by default matplotlib says
    # Quantity and unit of a second scale at the right, and what one unit is there.
    other: tuple[str, float] | None = None
    bounds: tuple[float, ...] = ()  # Horizontal lines that nothing crosses
    bound: str = "certified bound"  # What they are


@dataclass(frozen=True, slots=True, eq=False)
class PanelColumn:
    """A run: a column of panels."""

    title: str  # Above it; may be empty
    panels: tuple[Panel, ...]  # From top to bottom, alike in all columns
    span: tuple[float, float]  # Which time is shown, in s
    # From when to when which controller is in force; empty where there is but one.
    stays: tuple[tuple[float, float, str], ...] = ()
    instants: tuple[float, ...] = ()  # Times that a publication names, in s


@styled
def draw_panels(columns: Sequence[PanelColumn]) -> Figure:
    """Draw runs beside each other."""
    rows = len(columns[0].panels)
    figure = new_figure(1.1 + 1.45 * rows)
    grid = figure.subplots(rows, len(columns), sharex="col", sharey="row", squeeze=False)
    names = list(dict.fromkeys(name for column in columns for _, _, name in column.stays))
    handles: dict[str, Artist] = {}
    for place, column in enumerate(columns):
        for row, panel in enumerate(column.panels):
            axes: Axes = grid[row, place]
            _draw_panel(axes, panel, column, handles)
            _shade(axes, column, names, _LETTERS / len(columns) if row == 0 else 0.0)
            if place == 0:
                axes.set_ylabel(panel.label)
            if panel.other is not None and place == len(columns) - 1:
                _second_scale(axes, *panel.other)
        grid[-1, place].set(xlabel="Time [s]", xlim=column.span)
        if column.title:
            grid[0, place].set_title(column.title, fontsize=9.5, pad=18 if column.stays else 6)
    figure.align_ylabels(grid[:, 0])
    _legend(figure, handles, names)
    return figure


def _draw_panel(axes: Axes, panel: Panel, column: PanelColumn, handles: dict[str, Artist]) -> None:
    for curve in panel.curves:
        look = _PRINTED if curve.printed else _LOOKS[curve.look]
        t, y = (curve.t, curve.y) if curve.printed else _thinned(curve, column.span)
        (line,) = axes.plot(t, y, label=curve.label, **look)
        # What stands alone is named by its axis.
        if len(panel.curves) > 1:
            handles.setdefault(curve.label, line)
    for level in panel.limits:
        handles.setdefault(panel.limit, axes.axhline(level, **_LIMIT))
    for level in panel.bounds:
        handles.setdefault(panel.bound, axes.axhline(level, **_BOUND))
    if panel.ticks:
        axes.set_yticks(panel.ticks)
    for instant in column.instants:
        line = axes.axvline(instant, **_INSTANT)
        handles.setdefault("printed instant", line)


def _thinned(
    curve: Curve, span: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Thin a curve, keeping the least and the largest value of each part."""
    inside = (curve.t >= span[0]) & (curve.t <= span[1])
    t, y = curve.t[inside], curve.y[inside]
    if len(t) <= 2 * _PARTS:
        return t, y
    parts = np.array_split(np.arange(len(t)), _PARTS)
    kept = {0, len(t) - 1}
    for part in parts:
        seen = part[np.isfinite(y[part])]
        if len(seen):
            kept |= {int(seen[y[seen].argmin()]), int(seen[y[seen].argmax()])}
        # A gap stays one.
        kept |= set(part[~np.isfinite(y[part])][:1].tolist())
    picked = np.array(sorted(kept))
    return t[picked], y[picked]


def _shade(axes: Axes, column: PanelColumn, names: Sequence[str], letters: float) -> None:
    begin, end = column.span
    for start, stop, name in column.stays:
        low, high = max(start, begin), min(stop, end)
        if low >= high:
            continue
        tint = _SHADES[names.index(name) % len(_SHADES)]
        axes.axvspan(low, high, color=tint, alpha=_PALE, linewidth=0, zorder=0)
        if letters * (high - low) > (len(name) + 1) * (end - begin):
            middle, above = (low + high) / 2, axes.get_xaxis_transform()
            place: dict[str, Any] = {
                "transform": above,
                "ha": "center",
                "va": "bottom",
                "fontsize": 8.5,
            }
            axes.text(middle, 1.02, name, color=MUTED, **place)


def _second_scale(axes: Axes, label: str, factor: float) -> None:
    def there(y: ArrayLike) -> ArrayLike:
        return np.asarray(y, float) * factor

    def back(y: ArrayLike) -> ArrayLike:
        return np.asarray(y, float) / factor

    scale = axes.secondary_yaxis("right", functions=(there, back))
    scale.set_ylabel(label)
    scale.spines["right"].set_visible(False)


def _legend(figure: Figure, handles: dict[str, Artist], names: Sequence[str]) -> None:
    from nrs_design.plotting import Patch

    shades = [
        Patch(facecolor=_SHADES[i % len(_SHADES)], alpha=_PALE, label=f"controller: {name}")
        for i, name in enumerate(names)
    ]
    items = [*handles.values(), *shades]
    labels = [*handles, *(str(shade.get_label()) for shade in shades)]
    if not items:
        return
    columns = max(1, min(3, 70 // (max(map(len, labels)) + 6)))
    figure.set_figheight(figure.get_figheight() + 0.2 * -(-len(items) // columns))
    figure.legend(items, labels, loc="outside lower center", ncols=columns)
