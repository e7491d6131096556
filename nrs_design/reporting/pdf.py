"""The report as a tagged PDF: the same document, set by Typst."""

from __future__ import annotations

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

from nrs_design.output import MAKER
from nrs_design.reporting.document import (
    Block,
    Bullets,
    Derived,
    Illustration,
    Linked,
    Listing,
    Paragraph,
    Report,
    State,
    Table,
    parts_of,
)
from nrs_design.reporting.images import to_svg_file
from nrs_design.reporting.text import drawable

_TINT = {
    "proved": "#00664b",
    "refuted": "#a63603",
    "inconclusive": "#6b5b00",
    "identified": "#005a8c",
    "same": "#005a8c",
    "different": "#005a8c",
    "inside": "#00664b",
    "outside": "#a63603",
    "reachable": "#00664b",
    "unreachable": "#a63603",
}
_SHOWN = {
    State.GOOD: "#00664b",
    State.DOUBTFUL: "#6b5b00",
    State.BAD: "#a63603",
    State.UNKNOWN: "#4a5360",
}
# In points, between the margins of A4; a figure with its heading and caption fits on one page.
_WIDTH, _FIGURE_HEIGHT = 482.0, 610.0
_POINTS_PER_INCH = 72.0
_SPEC = "SHA-256 of the spec"
# What a column of a table has in common with any other: a short number fits, a sentence is folded.
_FEWEST_LETTERS, _MOST_LETTERS, _LETTER = 9, 60, 6.0


def render_pdf(report: Report) -> bytes:
    """Return the report as PDF on A4; the same report gives the same bytes.

    The file keeps to PDF/UA-1: headings, lists, tables and figures are tagged, figures have their
    caption as alternative text, and the sections are its outline. It has the date of the report
    or none, and its identifier follows from its content.
    """
    import typst

    from nrs_design.plotting import get_data_path

    template = files("nrs_design.reporting").joinpath("templates/report.typ").read_bytes()
    # The font that matplotlib brings along has Greek letters and is free.
    folder = str(Path(get_data_path()) / "fonts" / "ttf")
    fonts = typst.Fonts(
        include_system_fonts=False, include_embedded_fonts=False, font_paths=[folder]
    )
    return typst.compile(
        template,
        format="pdf",
        font_paths=fonts,
        sys_inputs={"report": json.dumps(_content(report))},
        pdf_standards=["ua-1"],
        timestamp=0,
    )


def _content(report: Report) -> dict[str, Any]:
    """Return all that the template shows."""
    facts = dict(report.facts)
    day = report.date
    return {
        "heading": drawable(f"{report.name}: {report.verdict}"),
        "name": drawable(report.name),
        "title": drawable(report.title),
        "verdict": report.verdict,
        "tint": _TINT[report.verdict],
        "keywords": [MAKER, *([f"sha256:{facts[_SPEC]}"] if _SPEC in facts else [])],
        "date": day and {"year": day.year, "month": day.month, "day": day.day},
        "claim": drawable(report.claim),
        "summary": [_said(sentence, report) for sentence in report.summary],
        "lights": [
            {
                "name": drawable(light.name),
                "text": drawable(light.text),
                "tint": _SHOWN[light.state],
            }
            for light in report.lights
        ],
        "remarks": [drawable(remark) for remark in report.remarks],
        "facts": [[drawable(label), _said(value, report)] for label, value in report.facts],
        "sections": [
            {
                "title": drawable(part.title),
                "name": f"section-{number}",
                "blocks": [_block(block, report) for block in part.blocks],
            }
            for number, part in enumerate(report.sections, 1)
        ],
        "footer": drawable(report.footer),
    }


def _said(text: str, report: Report) -> list[dict[str, str]]:
    """Return the parts of a text, each with the label that it leads to; empty for none."""
    return [{"text": drawable(part), "to": _target(part, report)} for part in parts_of(text)]


def _target(part: str, report: Report) -> str:
    if isinstance(part, Linked) and part.line <= report.listed:
        return f"line-{part.line}"
    return report.anchors.get(part.section, "") if isinstance(part, Derived) else ""


def _block(block: Block, report: Report) -> dict[str, Any]:
    if isinstance(block, Paragraph):
        return {"kind": "paragraph", "text": _said(block.text, report)}
    if isinstance(block, Bullets):
        items = [_said(item, report) for item in block.items]
        return {"kind": "bullets", "title": drawable(block.title), "items": items}
    if isinstance(block, Table):
        return {
            "kind": "table",
            "title": drawable(block.title),
            "columns": [drawable(cell) for cell in block.columns],
            "rows": [[_said(cell, report) for cell in row] for row in block.rows],
            "widths": _widths(block),
        }
    if isinstance(block, Listing):
        lines = [drawable(line) for line in block.lines]
        return {"kind": "listing", "title": drawable(block.title), "lines": lines}
    return _figure(block)


def _figure(block: Illustration) -> dict[str, Any]:
    width, height = (float(inches) * _POINTS_PER_INCH for inches in block.figure.get_size_inches())
    return {
        "kind": "illustration",
        "title": drawable(block.title),
        "caption": drawable(block.caption),
        "svg": to_svg_file(block.figure),
        "width": min(width, width * _FIGURE_HEIGHT / height),
    }


def _widths(table: Table) -> list[float]:
    """Divide the page by the longest text in each column; headings are folded between words."""
    heads = (max(map(len, head.split()), default=0) for head in table.columns)
    columns = zip(heads, *(map(len, row) for row in table.rows), strict=True)
    wanted = [min(max(*lengths, _FEWEST_LETTERS), _MOST_LETTERS) for lengths in columns]
    unit = min(_WIDTH / sum(wanted), _LETTER)
    return [unit * share for share in wanted]
