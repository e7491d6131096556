"""The report as one HTML page without scripts or anything to fetch."""

from __future__ import annotations

from typing import Any

from nrs_design.printable import visible
from nrs_design.reporting.document import Bullets, Illustration, Paragraph, Report, Section, Table
from nrs_design.reporting.images import to_svg

# More letters in a row than these do not fit on a telephone.
_NARROW = 36


def render_html(report: Report, origin: str | None = None) -> str:
    """Return the page; the same report gives the same bytes.

    Parameters
    ----------
    report : Report
        What is written.
    origin : str, optional
        Where its spec is, seen from the file; see `nrs_design.ownership`.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("nrs_design.reporting"),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_shown,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    sections = [_section(section) for section in report.sections]
    return environment.get_template("report.html.j2").render(
        report=report, sections=sections, origin=origin
    )


def _shown(value: object) -> object:
    """Escape invisible characters in all text that the template writes; markup has none."""
    from markupsafe import Markup

    return visible(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _section(section: Section) -> dict[str, Any]:
    return {
        "title": section.title,
        "boxed": section.boxed,
        "blocks": [_block(block) for block in section.blocks],
    }


def _block(block: Paragraph | Bullets | Table | Illustration) -> dict[str, Any]:
    from markupsafe import Markup

    # The only markup that is not escaped: matplotlib's own.
    svg = Markup(to_svg(block)) if isinstance(block, Illustration) else None
    wide = isinstance(block, Table) and _letters(block) > _NARROW
    return {"kind": type(block).__name__.lower(), "content": block, "svg": svg, "wide": wide}


def _letters(table: Table) -> int:
    """Return how many letters the widest row takes, if every column is as wide as its longest."""
    rows = [table.columns, *table.rows]
    return sum(max(map(len, column)) for column in zip(*rows, strict=True))
