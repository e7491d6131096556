"""The page of two specs or certificates beside each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from nrs_design.comparison import Comparison, Difference, Part
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Block, Bullets, Paragraph, Report, Section, Table

_TITLES = {
    Part.SPEC: "What the specs say",
    Part.GAINS: "Gains that ship",
    Part.MARGINS: "Margins (computed, not proved)",
    Part.VERDICT: "Verdict",
    Part.ASSUMPTIONS: "Taken for granted",
}


def comparison_report(found: Comparison) -> Report:
    """Return the report of a comparison."""
    count = len(found.differences)
    said = counted(count, "difference") if count else "No difference in what was compared"
    return Report(
        name="comparison",
        title=f"{found.before.name} and {found.after.name}",
        verdict="different" if count else "same",
        claim=f"{said}.",
        remarks=found.remarks,
        facts=(("A", str(found.before.path)), ("B", str(found.after.path))),
        sections=tuple(_sections(found)),
        footer="Specs were designed and certified afresh, certificates re-checked.",
    )


def _sections(found: Comparison) -> Iterator[Section]:
    for part in found.compared:
        items = [item for item in found.differences if item.part is part]
        blocks = tuple(_blocks(items)) if items else (Paragraph("The same in both."),)
        yield Section(_TITLES[part], blocks)


def _blocks(items: Sequence[Difference]) -> Iterator[Block]:
    rows = [(i.what, i.before or "–", i.after or "–") for i in items if not i.is_text]
    if rows:
        yield Table("", ("", "A", "B"), tuple(rows))
    texts = [item for item in items if item.is_text]
    for side, held in (("A", [i.before for i in texts]), ("B", [i.after for i in texts])):
        if said := tuple(text for text in held if text is not None):
            yield Bullets(f"Only {side}", said)
