"""Figures as SVG elements of one HTML page, as SVG files, and as PNG images."""

from __future__ import annotations

import html
import io
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from nrs_design.output import MAKER, SVG_MARK
from nrs_design.reporting.document import Illustration
from nrs_design.reporting.formatting import drawable
from nrs_design.reporting.style import THEMED, figure_style

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The date would differ from run to run, and the other metadata hold addresses.
_NO_METADATA = {"Date": None, "Creator": None, "Format": None, "Type": None}


def render_svg(illustration: Illustration) -> str:
    """Return an ``<svg>`` element, the same bytes for the same figure.

    Its ids begin with the illustration's name: matplotlib names the outline of a letter alike in
    every figure, and an id must be unique in the page. What has a label carries it as its title,
    colours are those of the page, which knows light and dark, and the axes are told to its script.
    """
    figure, prefix = illustration.figure, illustration.name
    with _label_elements(figure) as titles:
        svg = _savefig(figure)
    svg = svg[svg.index("<svg") :].rstrip()
    themed = _is_themed(figure)
    look = "" if themed else ' class="plain"'
    title = html.escape(drawable(illustration.title))
    places = json.dumps(_axes(figure), separators=(",", ":"))
    head = f'role="img" aria-label="{title}" data-axes=\'{places}\'{look}>'
    # Not as a pattern of replacement: a title may hold anything.
    begin = re.compile(r'^<svg[^>]*? viewBox="([^"]*)"[^>]*>')
    svg = begin.sub(lambda found: f'<svg viewBox="{found[1]}" {head}', svg)
    for name, title in titles.items():
        titled = f'<g id="{name}" data-named=""><title>{html.escape(drawable(title))}</title>'
        svg = svg.replace(f'<g id="{name}">', titled)
    if themed:
        svg = re.sub("#[0-9a-f]{6}", lambda found: THEMED.get(found[0], found[0]), svg)
    # A hundredth of a point is not seen, and half of the file are such digits.
    svg = re.sub(r' d="[^"]*"', lambda path: re.sub(r"(\.\d\d)\d+", r"\1", path[0]), svg)
    svg = svg.replace("xlink:href=", "href=")
    svg = re.sub(r'\bid="', f'id="{prefix}-', svg)
    svg = re.sub(r'href="#', f'href="#{prefix}-', svg)
    return svg.replace("url(#", f"url(#{prefix}-")


@contextmanager
def _label_elements(figure: Figure) -> Iterator[dict[str, str]]:
    """Give all that has a label an id for a while; yield the labels by these ids."""
    labelled: list[tuple[Artist, str]] = [
        (artist, str(artist.get_label()))
        for axes in figure.axes
        for artist in (*axes.lines, *axes.collections, *axes.patches)
        if not str(artist.get_label()).startswith("_") and str(artist.get_label())
    ]
    for number, (artist, _) in enumerate(labelled):
        artist.set_gid(f"named-{number}")
    try:
        yield {f"named-{number}": label for number, (_, label) in enumerate(labelled)}
    finally:
        for artist, _ in labelled:
            artist.set_gid(None)


def _is_themed(figure: Figure) -> bool:
    """Tell whether the page's colours suit a figure; those of a heat map have a meaning."""
    from nrs_design.plotting import QuadMesh

    items = (item for axes in figure.axes for item in axes.collections)
    return not any(isinstance(item, QuadMesh) for item in items)


def _axes(figure: Figure) -> list[list[float | bool]]:
    """Return position (points from the upper left), limits and scales of all numeric axes."""
    width, height = (72 * float(inches) for inches in figure.get_size_inches())
    found = []
    for axes in figure.axes:
        box = axes.get_position()
        if not axes.get_visible() or not _is_numeric(axes):
            continue
        limits = [*axes.get_xlim(), *axes.get_ylim()]
        place = [width * box.x0, height * (1 - box.y1), width * box.x1, height * (1 - box.y0)]
        logs = [axes.get_xscale() == "log", axes.get_yscale() == "log"]
        found.append([*(float(f"{v:.6g}") for v in (*place, *limits)), *logs])
    return found


def _is_numeric(axes: Axes) -> bool:
    """Tell whether places on both axes are numbers, not names."""
    from nrs_design.plotting import FixedFormatter

    return not any(
        isinstance(axis.get_major_formatter(), FixedFormatter) for axis in (axes.xaxis, axes.yaxis)
    )


def render_svg_file(figure: Figure) -> str:
    """Return a standalone SVG file with the mark of this program, equal for equal figures."""
    declaration, _, element = _savefig(figure).partition("\n")
    return f"{declaration}\n{SVG_MARK}{element}"


def render_png(figure: Figure, dpi: int = 200) -> bytes:
    """Return the figure as a PNG image that says who made it, without a date."""
    buffer = io.BytesIO()
    with figure_style():
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": MAKER})
    return buffer.getvalue()


def _savefig(figure: Figure) -> str:
    buffer = io.StringIO()
    with figure_style():
        figure.savefig(buffer, format="svg", metadata=_NO_METADATA)
    # matplotlib names an outline by a hash of its position. The last bit of the position depends
    # on addresses in memory, so that the outlines are numbered instead.
    names: dict[str, str] = {}
    return re.sub(
        r"\bp[0-9a-f]{10}\b",
        lambda found: names.setdefault(found[0], f"outline-{len(names)}"),
        buffer.getvalue(),
    )
