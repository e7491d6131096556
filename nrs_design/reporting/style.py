"""The look that all figures share: one palette, one type size, ticks in full, no state outside."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from functools import wraps
from typing import TYPE_CHECKING, Any, ParamSpec

from nrs_design.reporting.formatting import wrapped_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Okabe and Ito's palette, which colour-blind readers can tell apart, without its yellow, which
# is too faint on white.
CYCLE = ("#0072B2", "#D55E00", "#009E73", "#AA4499", "#56B4E9", "#E69F00")
BLUE, VERMILLION, GREEN, PURPLE, SKY, ORANGE = CYCLE
MARKERS = ("o", "s", "^", "D", "v", "P", "X", "*")
DASHES = ("-", (0, (6, 2)), (0, (2, 1.5)), (0, (6, 2, 1.5, 2)))
# Number of series that differ in color or marker.
MAX_SERIES = 24
ALARM = "#a00000"
INK, MUTED, GRID = "#1b1f24", "#5a6472", "#dfe3e8"

# Names of the colours in a page, which has a light and a dark theme; files keep the colours.
_PAGE_COLORS = {"ink": INK, "muted": MUTED, "grid": GRID, "paper": "#ffffff", "alarm": ALARM}
_NAMES = ("blue", "vermillion", "green", "purple", "sky", "orange")
_PAGE_COLORS |= dict(zip(_NAMES, CYCLE, strict=True))
THEMED = {tint.lower(): f"var(--{name},{tint})" for name, tint in _PAGE_COLORS.items()}

# Width in inches; text of this figure is legible when a telephone scales it to the page.
_WIDTH = 5.4
_LABEL_LETTERS = 24
# In points.
_LETTERS = 10.0
_LEGEND_LETTERS, _LEGEND_LINE, _LEGEND_GAP = 46, 0.175, 0.055

_SETTINGS = {
    "svg.hashsalt": "nrs-design",
    # Outlines look the same on every reader's machine and need no font there.
    "svg.fonttype": "path",
    # A name with two dollars is no formula; the axes' own numbers need none either.
    "text.parse_math": False,
    "font.family": ["DejaVu Sans"],
    "font.size": _LETTERS,
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
    "legend.fontsize": 9.5,
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
}

# Letters of a paper, in points, and the settings that go with them.
_PAPER_LETTERS = 8.0
_SIZES = ("font.size", *(f"{artist}.labelsize" for artist in ("axes", "xtick", "ytick")))
_PAPER = dict.fromkeys((*_SIZES, "axes.titlesize", "legend.fontsize"), _PAPER_LETTERS)
_PAPER["lines.linewidth"] = 1.2

P = ParamSpec("P")


@dataclass(frozen=True, slots=True)
class _Sheet:
    """Width and letter size of a figure."""

    width: float = _WIDTH  # In inches
    letters: float = _LETTERS  # In points
    paper: bool = False

    @property
    def room(self) -> float:
        """Letters per line, relative to a figure of the report."""
        return self.width / _WIDTH * _LETTERS / self.letters


_PAGE = _Sheet()
_SHEET: ContextVar[_Sheet] = ContextVar("sheet", default=_PAGE)


@contextmanager
def for_paper(width: float | None) -> Iterator[None]:
    """Set width in inches and letter size of a paper; None keeps the current settings."""
    token = _SHEET.set(_SHEET.get() if width is None else _Sheet(width, _PAPER_LETTERS, paper=True))
    try:
        yield
    finally:
        _SHEET.reset(token)


@contextmanager
def figure_style() -> Iterator[None]:
    """Use the report's settings whatever any matplotlib file says."""
    from nrs_design.plotting import style

    with style.context(["default", _SETTINGS | (_PAPER if _SHEET.get().paper else {})]):
        yield


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Run a drawing function within `figure_style`, and settle the layout of its figure.

    The layout is found by iteration from the last one, so a figure laid out anew at every
    rendering would differ from one to the next.
    """

    @wraps(draw)
    def draw_styled(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with figure_style():
            figure = draw(*args, **kwargs)
            _shrink(figure)
            settle(figure)
            return figure

    return draw_styled


def _shrink(figure: Figure) -> None:
    """Let no text of a figure for a paper be larger than its letters."""
    from nrs_design.plotting import Text

    if _SHEET.get().paper:
        for text in figure.findobj(Text):
            assert isinstance(text, Text)
            text.set_fontsize(min(text.get_fontsize(), _PAPER_LETTERS))


def settle(figure: Figure) -> None:
    """Fix the layout of a figure once; a fixed aspect ratio needs a drawing for this."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    write_ticks_in_full(figure)
    if any(a.get_aspect() != "auto" or a.get_box_aspect() is not None for a in figure.axes):
        figure.draw_without_rendering()
    else:
        engine.execute(figure)
    figure.set_layout_engine(None)


def new_figure(height: float = 3.9) -> Figure:
    """Return an empty figure of the width of report or paper, and a height in inches."""
    from nrs_design.plotting import Figure

    sheet = _SHEET.get()
    high = height * sheet.letters / _LETTERS
    return Figure(figsize=(sheet.width, high), layout="constrained")


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


def curve(index: int, count: int, points: int) -> dict[str, Any]:
    """Return the look of one of several curves, which shows also where they coincide.

    Each has a marker of its own at places of its own, so that curves on top of each other show
    the markers of all in turn.
    """
    step = max(points // 8, 1)
    return {
        "color": color(index),
        "marker": marker(index),
        "markersize": 5.0,
        "markevery": (step * index // max(count, 1) % step, step),
        "linestyle": DASHES[index // len(CYCLE) % len(DASHES)],
    }


def row_labels(names: Sequence[str]) -> tuple[list[str], float]:
    """Return names in full as labels of rows, and the height in inches that one row needs."""
    room = _SHEET.get().room
    labels = [wrapped_label(name, round(_LABEL_LETTERS * min(room, 1.0))) for name in names]
    lines = max((label.count("\n") for label in labels), default=0) + 1
    return labels, 0.11 + 0.16 * lines


def legend(figure: Figure, axes: Axes, columns: int = 2) -> None:
    """Put a legend below the axes, where it hides no data, and make the figure higher for it.

    A single series has none. Names are written in full, on several lines where they are long.
    """
    handles, labels = axes.get_legend_handles_labels()
    if len(handles) < 2:
        return
    sheet = _SHEET.get()
    texts = [wrapped_label(label, round(_LEGEND_LETTERS * sheet.room)) for label in labels]
    longest = max(len(line) for text in texts for line in text.splitlines())
    columns = max(1, min(columns, len(handles), round(66 * sheet.room) // (longest + 6)))
    rows = -(-len(handles) // columns)
    lines = rows + sum(text.count("\n") for text in texts) / columns
    extra_height = _LEGEND_LINE * (lines - 1) + _LEGEND_GAP * (rows - 1)
    extra_height *= sheet.letters / _LETTERS
    figure.set_figheight(figure.get_figheight() + extra_height)
    figure.legend(handles, texts, loc="outside lower center", ncols=columns)


_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def write_ticks_in_full(figure: Figure) -> None:
    """Replace the formatters of all numeric axes: no offset, no common factor in a corner."""
    from nrs_design.plotting import LogFormatter, ScalarFormatter

    class PlainFormatter(ScalarFormatter):
        def format_ticks(self, values: Sequence[float]) -> list[str]:
            distance = float(values[1] - values[0]) if len(values) > 1 else None
            return [format_tick(value, distance or abs(value) or 1.0) for value in values]

    class PowerFormatter(LogFormatter):
        def __call__(self, value: float, pos: int | None = None) -> str:
            # On an axis of few decades, ticks between powers have labels.
            return format_tick(value, abs(value) or 1.0) if super().__call__(value, pos) else ""

    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            if isinstance(axis.get_major_formatter(), LogFormatter):
                axis.set_major_formatter(PowerFormatter(labelOnlyBase=True))
                axis.set_minor_formatter(PowerFormatter(labelOnlyBase=False))
            elif isinstance(axis.get_major_formatter(), ScalarFormatter):
                axis.set_major_formatter(PlainFormatter(useOffset=False))


def format_tick(value: float, step: float) -> str:
    """Write a tick with the digits that tell it from its neighbour one step away."""
    if abs(value) < 1e-9 * step:
        return "0"
    exponent = math.floor(math.log10(abs(value)) + 1e-12)
    fine = math.floor(math.log10(step) + 1e-12)
    if -5 < exponent < 7:
        return _trimmed(f"{value:.{max(0, 2 - fine)}f}")
    mantissa = _trimmed(f"{value / 10.0**exponent:.{max(0, exponent - fine + 2)}f}")
    power = f"10{str(exponent).translate(_SUPERSCRIPT)}"
    if mantissa in ("1", "−1"):
        return mantissa.replace("1", power)
    return f"{mantissa}·{power}"


def _trimmed(digits: str) -> str:
    if "." in digits:
        digits = digits.rstrip("0").rstrip(".")
    return digits.replace("-", "−")
