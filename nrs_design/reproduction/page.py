"""The table as one self-contained HTML page."""

from __future__ import annotations

from nrs_design import __version__
from nrs_design.reproduction.comparison import ReproducedValue
from nrs_design.reproduction.table import count_verdicts


def render_page(table: tuple[ReproducedValue, ...], gallery: str | None = None) -> str:
    """Return the page; the same rows give the same bytes.

    Parameters
    ----------
    table : tuple of ReproducedValue
        Its rows.
    gallery : str, optional
        Where the page of figures is, seen from this one.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("nrs_design.reproduction"),
        autoescape=True,
        undefined=StrictUndefined,
        keep_trailing_newline=True,
    )
    environment.filters["deviation"] = format_deviation
    template = environment.get_template("reproduce.html.j2")
    counts = count_verdicts(table)
    return template.render(rows=table, counts=counts, gallery=gallery, version=__version__)


def format_deviation(deviation: float | None) -> str:
    """Write a deviation with two digits, and none at all as nothing."""
    return "" if deviation is None else f"{deviation:.1e}" if deviation else "0"
