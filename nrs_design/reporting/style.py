"""The look that all figures share: one palette, one type size, no state outside a figure."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import TYPE_CHECKING, ParamSpec

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's palette, which colour-blind readers can tell apart, without its yellow, which
# is too faint on white.
BLUE, VERMILLION, GREEN, PURPLE, SKY, ORANGE = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#AA4499",
    "#56B4E9",
    "#E69F00",
)
CYCLE = (BLUE, VERMILLION, GREEN, PURPLE, SKY, ORANGE)
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
ALARM = "#a00000"
INK, MUTED, GRID = "#1b1f24", "#5a6472", "#dfe3e8"

_SETTINGS = {
    "svg.hashsalt": "nrs-design",
    # Outlines look the same on every reader's machine and need no font there.
    "svg.fonttype": "path",
    "font.family": ["DejaVu Sans"],
    "font.size": 10.0,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "legend.fontsize": 9.0,
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
}

P = ParamSpec("P")


@contextmanager
def figure_style() -> Iterator[None]:
    """Use the report's settings whatever the reader's own matplotlib file says."""
    from matplotlib import style

    with style.context(["default", _SETTINGS]):
        yield


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Run a drawing function within `figure_style`, and settle the layout of its figure.

    The layout is found by iteration from the last one, so a figure laid out anew at every
    rendering would differ from one to the next.
    """

    @wraps(draw)
    def drawn(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with figure_style():
            figure = draw(*args, **kwargs)
            figure.draw_without_rendering()
            figure.set_layout_engine("none")
            return figure

    return drawn


def new_figure(height: float = 3.9) -> Figure:
    """Return an empty figure of the report's width (6.6 inches) and a height in inches."""
    from matplotlib.figure import Figure

    return Figure(figsize=(6.6, height), layout="constrained")


def new_axes(height: float = 3.9) -> tuple[Figure, Axes]:
    """Return a new figure with one pair of axes."""
    figure = new_figure(height)
    return figure, figure.add_subplot()


def color(index: int) -> str:
    """Return the color of the n-th series."""
    return CYCLE[index % len(CYCLE)]


def marker(index: int) -> str:
    """Return the marker of the n-th series, so that color is never the only difference."""
    return MARKERS[index % len(MARKERS)]


def short(name: str, limit: int = 26) -> str:
    """Shorten a name for a label in a figure; the tables have it in full."""
    if len(name) <= limit:
        return name
    head = limit // 2
    return f"{name[:head]}…{name[head + 1 - limit :]}"


def legend(figure: Figure, axes: Axes, columns: int = 2) -> None:
    """Put a legend below the axes, where it hides no data; none for a single series."""
    handles, labels = axes.get_legend_handles_labels()
    if len(handles) > 1:
        columns = min(columns, len(handles))
        figure.legend(handles, labels, loc="outside lower center", ncols=columns)
