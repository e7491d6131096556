"""Reports for people: one document, rendered as HTML."""

from nrs_design.reporting.document import Report
from nrs_design.reporting.render import render_html
from nrs_design.reporting.report import build_report

__all__ = ["Report", "build_report", "render_html"]
