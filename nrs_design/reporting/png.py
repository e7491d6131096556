"""The figures of the report as images."""

from __future__ import annotations

from nrs_design.reporting.document import Report
from nrs_design.reporting.svg import to_png


def render_png(report: Report) -> dict[str, bytes]:
    """Return every figure as a PNG image at 200 dots per inch, by its name."""
    return {item.name: to_png(item.figure) for item in report.illustrations}
