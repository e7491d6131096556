"""Figures as SVG elements that can stand beside others in one HTML page, and as PNG images."""

from __future__ import annotations

import io
import re
from typing import TYPE_CHECKING

from nrs_design.reporting.document import Illustration, Report
from nrs_design.reporting.style import figure_style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Of the metadata, the date would differ from run to run and the rest holds addresses.
_NO_METADATA = {"Date": None, "Creator": None, "Format": None, "Type": None}


def to_svg(illustration: Illustration) -> str:
    """Return an ``<svg>`` element, the same bytes for the same figure.

    Its ids begin with the illustration's name: matplotlib names the outline of a letter alike in
    every figure, and an id must be unique in the page.
    """
    svg = _savefig(illustration.figure)
    svg = svg[svg.index("<svg") :].rstrip()
    svg = re.sub(r'^<svg[^>]*? viewBox="([^"]*)"[^>]*>', r'<svg viewBox="\1" role="img">', svg)
    svg = svg.replace("xlink:href=", "href=")
    prefix = illustration.name
    svg = re.sub(r'\bid="', f'id="{prefix}-', svg)
    svg = re.sub(r'href="#', f'href="#{prefix}-', svg)
    return svg.replace("url(#", f"url(#{prefix}-")


def to_svg_file(figure: Figure) -> str:
    """Return the text of an SVG file of its own, the same bytes for the same figure."""
    return _savefig(figure)


def to_png(figure: Figure, dpi: int = 200) -> bytes:
    """Return the figure as a PNG image without date or program name."""
    buffer = io.BytesIO()
    with figure_style():
        figure.savefig(buffer, format="png", dpi=dpi, metadata={"Software": None})
    return buffer.getvalue()


def render_png(report: Report) -> dict[str, bytes]:
    """Return every figure as a PNG image at 200 dots per inch, by its name."""
    return {item.name: to_png(item.figure) for item in report.illustrations}


def _savefig(figure: Figure) -> str:
    buffer = io.StringIO()
    with figure_style():
        figure.savefig(buffer, format="svg", metadata=_NO_METADATA)
    return buffer.getvalue()
