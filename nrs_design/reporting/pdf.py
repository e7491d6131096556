"""The report as PDF: the same document, set by reportlab."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any
from xml.sax.saxutils import escape

from nrs_design.reporting.document import Bullets, Illustration, Paragraph, Report, Section, Table
from nrs_design.reporting.style import GRID, MUTED
from nrs_design.reporting.svg import to_png

_BADGE = {
    "proved": "#00664b",
    "refuted": "#a63603",
    "inconclusive": "#6b5b00",
    "identified": "#005a8c",
}
_WIDTH = 482.0
_MARGIN = 56.0


def render_pdf(report: Report) -> bytes:
    """Return the report as PDF on A4; the same report gives the same bytes."""
    from reportlab.lib.pagesizes import A4
    from reportlab.platypus import SimpleDocTemplate

    _register_fonts()
    buffer = io.BytesIO()
    document = SimpleDocTemplate(
        buffer,
        pagesize=A4,
        leftMargin=_MARGIN,
        rightMargin=_MARGIN,
        topMargin=_MARGIN,
        bottomMargin=_MARGIN,
        title=f"{report.name}: {report.verdict}",
        author="",
        subject=report.title,
        creator="nrs-design",
        # Dates and document ids would differ from run to run.
        invariant=1,
    )
    styles = _styles(report.verdict)
    document.build(
        list(_story(report, styles)), onFirstPage=_number_page, onLaterPages=_number_page
    )
    return buffer.getvalue()


def _register_fonts() -> None:
    """Use the font that matplotlib brings along: it has Greek letters and is free."""
    from pathlib import Path

    import matplotlib
    from reportlab.lib.fonts import addMapping
    from reportlab.pdfbase.pdfmetrics import registerFont
    from reportlab.pdfbase.ttfonts import TTFont

    folder = Path(matplotlib.get_data_path()) / "fonts" / "ttf"
    for name in ("DejaVuSans", "DejaVuSans-Bold"):
        registerFont(TTFont(name, str(folder / f"{name}.ttf")))
    addMapping("DejaVuSans", 0, 0, "DejaVuSans")
    addMapping("DejaVuSans", 1, 0, "DejaVuSans-Bold")


def _styles(verdict: str) -> dict[str, Any]:
    from reportlab.lib.colors import HexColor, white
    from reportlab.lib.styles import ParagraphStyle

    body = ParagraphStyle("body", fontName="DejaVuSans", fontSize=9, leading=13, spaceAfter=5)
    tint = HexColor(_BADGE[verdict])
    return {
        "body": body,
        "cell": ParagraphStyle("cell", body, fontSize=7.8, leading=10, spaceAfter=0),
        "muted": ParagraphStyle("muted", body, fontSize=8, leading=11, textColor=HexColor(MUTED)),
        "claim": ParagraphStyle(
            "claim",
            body,
            fontSize=10,
            leading=14,
            borderColor=tint,
            borderWidth=0.8,
            borderPadding=6,
            spaceBefore=9,
            spaceAfter=12,
        ),
        "remark": ParagraphStyle("remark", body, spaceAfter=9),
        "badge": ParagraphStyle(
            "badge",
            body,
            fontName="DejaVuSans-Bold",
            textColor=white,
            backColor=tint,
            borderPadding=4,
            spaceAfter=8,
        ),
        "h1": ParagraphStyle(
            "h1", body, fontName="DejaVuSans-Bold", fontSize=18, leading=23, spaceBefore=4
        ),
        "h2": ParagraphStyle(
            "h2",
            body,
            fontName="DejaVuSans-Bold",
            fontSize=12.5,
            leading=16,
            spaceBefore=12,
            keepWithNext=1,
        ),
        "h3": ParagraphStyle(
            "h3", body, fontName="DejaVuSans-Bold", fontSize=9.5, spaceBefore=6, keepWithNext=1
        ),
    }


def _story(report: Report, styles: dict[str, Any]) -> Iterator[Any]:
    yield _text(report.verdict.upper(), styles["badge"])
    yield _text(report.name, styles["h1"])
    if report.title:
        yield _text(report.title, styles["muted"])
    yield _text(report.claim, styles["claim"])
    for remark in report.remarks:
        yield _text(remark, styles["remark"])
    yield from _facts(report, styles)
    for section in report.sections:
        yield from _section(section, styles)


def _facts(report: Report, styles: dict[str, Any]) -> Iterator[Any]:
    yield from _table(Table("", ("", ""), report.facts), styles, heading=False)


def _section(section: Section, styles: dict[str, Any]) -> Iterator[Any]:
    from reportlab.platypus import KeepTogether

    heading, blocks = _text(section.title, styles["h2"]), section.blocks
    if isinstance(blocks[0], Illustration):
        yield KeepTogether([heading, *_illustration(blocks[0], styles)])
        blocks = blocks[1:]
    else:
        yield heading
    for block in blocks:
        if isinstance(block, Paragraph):
            yield _text(block.text, styles["body"])
        elif isinstance(block, Bullets):
            yield from _bullets(block, styles)
        elif isinstance(block, Table):
            yield from _table(block, styles)
        else:
            yield KeepTogether(list(_illustration(block, styles)))


def _bullets(block: Bullets, styles: dict[str, Any]) -> Iterator[Any]:
    from reportlab.platypus import ListFlowable, ListItem

    if block.title:
        yield _text(block.title, styles["h3"])
    items: list[Any] = [
        ListItem(_text(item, styles["body"]), leftIndent=12) for item in block.items
    ]
    yield ListFlowable(items, bulletType="bullet", start="•", leftIndent=12, bulletFontSize=8)


def _table(table: Table, styles: dict[str, Any], *, heading: bool = True) -> Iterator[Any]:
    from reportlab.lib.colors import HexColor
    from reportlab.platypus import Spacer
    from reportlab.platypus import Table as Grid

    if table.title:
        yield _text(table.title, styles["h3"])
    rows = [[_text(cell, styles["cell"]) for cell in row] for row in table.rows]
    if heading:
        rows.insert(0, [_text(cell, styles["cell"], bold=True) for cell in table.columns])
    line, rule = HexColor(GRID), HexColor(MUTED)
    yield Grid(
        rows,
        colWidths=_widths(table),
        repeatRows=int(heading),
        hAlign="LEFT",
        style=[
            ("LINEBELOW", (0, 0), (-1, -1), 0.4, line),
            *([("LINEBELOW", (0, 0), (-1, 0), 0.9, rule)] if heading else []),
            ("VALIGN", (0, 0), (-1, -1), "TOP"),
            ("LEFTPADDING", (0, 0), (-1, -1), 0),
            ("TOPPADDING", (0, 0), (-1, -1), 2),
            ("BOTTOMPADDING", (0, 0), (-1, -1), 2),
        ],
    )
    yield Spacer(1, 8)


def _widths(table: Table) -> list[float]:
    """Divide the page by the longest text in each column, none narrower than a short number."""
    columns = zip(table.columns, *table.rows, strict=True)
    wanted = [min(max(max(map(len, column)), 9), 60) for column in columns]
    unit = min(_WIDTH / sum(wanted), 6.0)
    return [unit * share for share in wanted]


def _illustration(block: Illustration, styles: dict[str, Any]) -> Iterator[Any]:
    from reportlab.platypus import Image

    width, height = block.figure.get_size_inches()
    shown = 0.88 * _WIDTH
    image = Image(io.BytesIO(to_png(block.figure)), width=shown, height=shown * height / width)
    image.hAlign = "LEFT"
    yield from (_text(block.title, styles["h3"]), image, _text(block.caption, styles["muted"]))


def _text(text: str, style: Any, *, bold: bool = False) -> Any:
    from reportlab.platypus import Paragraph as Flowing

    escaped = escape(text)
    return Flowing(f"<b>{escaped}</b>" if bold else escaped, style)


def _number_page(canvas: Any, document: Any) -> None:
    canvas.setFont("DejaVuSans", 8)
    canvas.drawRightString(document.pagesize[0] - _MARGIN, 30, str(document.page))
