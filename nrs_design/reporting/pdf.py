"""The report as PDF."""

from __future__ import annotations

from nrs_design.reporting.document import Report


def render_pdf(report: Report) -> bytes:
    """Return the PDF."""
    raise NotImplementedError
