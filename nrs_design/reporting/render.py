"""The report as one self-contained HTML page; without its script, all content remains."""

from __future__ import annotations

import base64
import hashlib
import html
from importlib.resources import files
from typing import Any

from nrs_design.printable import visible
from nrs_design.reporting.document import (
    Block,
    Illustration,
    Report,
    Section,
    State,
    Table,
)
from nrs_design.reporting.images import render_svg

# More letters in a row than these do not fit on a telephone, or in one line of a page.
_NARROW, _LINE = 36, 106
# A last column of at most these letters, such as "not met", is not broken.
_WORD = 16
# Between two columns, in letters.
_GAP = 2
# Not only a colour tells how things stand.
_SIGNS = {State.GOOD: "✓", State.DOUBTFUL: "▲", State.BAD: "✗", State.UNKNOWN: "?"}


def render_html(report: Report, origin: str | None = None) -> str:
    """Return the page; the same report gives the same bytes.

    The origin is where its spec is, seen from the file; see `nrs_design.certificates.ownership`.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    environment = Environment(
        loader=PackageLoader("nrs_design.reporting"),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_escape_invisible,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    sections = [_section(section, f"section-{n}") for n, section in enumerate(report.sections, 1)]
    checking = ("check.js", "check_page.js") if report.certificate else ()
    script = "\n".join(map(_script, ["report.js", *checking]))
    return environment.get_template("report.html.j2").render(
        report=report,
        sections=sections,
        origin=origin,
        signs=_SIGNS,
        # Quotes stay, which are half of it.
        numbers=Markup(html.escape(report.certificate, quote=False)),
        script=Markup(script),
        script_hash=base64.b64encode(hashlib.sha256(script.encode()).digest()).decode(),
    )


def _script(name: str) -> str:
    text = files("nrs_design.reporting").joinpath(f"templates/{name}").read_text("utf-8")
    return text.replace("\r\n", "\n")


def _escape_invisible(value: object) -> object:
    """Escape invisible characters of text; markup is returned unchanged."""
    from markupsafe import Markup

    return visible(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _section(section: Section, name: str) -> dict[str, Any]:
    return {
        "id": name,
        "title": section.title,
        "boxed": section.boxed,
        "folded": section.folded,
        "blocks": [_block(block) for block in section.blocks],
    }


def _block(block: Block) -> dict[str, Any]:
    from markupsafe import Markup

    # The only markup that is not escaped: matplotlib's own.
    svg = Markup(render_svg(block)) if isinstance(block, Illustration) else None
    look = _look(block) if isinstance(block, Table) else ""
    return {"kind": type(block).__name__.lower(), "content": block, "svg": svg, "look": look}


def _look(table: Table) -> str:
    """Return the style classes of a table that is too wide for a telephone or for a page."""
    rows = [table.columns, *table.rows]
    # Width in letters if no cell is broken.
    letters = sum(_GAP + max(map(len, column)) for column in zip(*rows, strict=True))
    if letters <= _LINE:
        return "wide" if letters > _NARROW else ""
    last = max((len(row[-1]) for row in table.rows), default=0)
    return "wide prose brief" if last <= _WORD else "wide prose"
