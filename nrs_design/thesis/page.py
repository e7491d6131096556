"""The table as one self-contained HTML page."""

from __future__ import annotations

from nrs_design import __version__
from nrs_design.thesis.comparison import ReproducedValue
from nrs_design.thesis.table import (
    CONVERTED,
    count_verdicts,
    counts_line,
    printed_errors,
)


def render_page(table: tuple[ReproducedValue, ...], gallery: str | None = None) -> str:
    """Return the page; the same rows give the same bytes."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("nrs_design.thesis"),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    environment.globals["within"] = format_within
    template = environment.get_template("reproduce.html.j2")
    return template.render(
        rows=table,
        counts=count_verdicts(table),
        errors=printed_errors(table),
        summary=counts_line(table),
        converted=CONVERTED,
        gallery=gallery,
        version=__version__,
    )


def format_within(deviation: float | None, limit: str) -> str:
    """Write a deviation with two digits and the limit that it is held to; none at all as nothing.

    It is relative, or absolute where what it is from is zero.
    """
    if deviation is None:
        return ""
    return f"{f'{deviation:.1e}' if deviation else '0'} ({limit})"
