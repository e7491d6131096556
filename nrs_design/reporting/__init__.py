"""Reports for people: one document, rendered as HTML or PNG figures."""

from nrs_design.reporting.document import Report
from nrs_design.reporting.images import render_png
from nrs_design.reporting.render import render_html
from nrs_design.reporting.report import build_report

__all__ = ["Report", "build_report", "render_html", "render_png"]
