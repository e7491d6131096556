"""For a README: a badge with the verdict, as SVG."""

from __future__ import annotations

from html import escape

from nrs_design.gating.obligations import GateOutcome, count_by_verdict

# The colours of the reports: dark enough for white letters.
_GOOD, _BAD, _OPEN = "#00664b", "#a63603", "#6b5b00"
_NAME = "switching"
# Width of a letter of 11 px, and what is left beside a word.
_LETTER, _BESIDE = 6.6, 12


def to_badge(outcome: GateOutcome) -> str:
    """Return the badge: how many specs are proved, or how many obligations are not fulfilled."""
    said, colour = _said(outcome)
    left, right = (round(_LETTER * len(text)) + _BESIDE for text in (_NAME, said))
    label = escape(f"{_NAME}: {said}")
    place = f'y="14" text-anchor="middle" textLength="{round(_LETTER * len(said))}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + right}" height="20" role="img" '
        f'aria-label="{label}">\n<!-- nrs-design badge --><title>{label}</title>\n'
        f'<rect width="{left}" height="20" fill="#1b1f24"/>'
        f'<rect x="{left}" width="{right}" height="20" fill="{colour}"/>\n'
        '<g fill="#fff" font-family="Verdana,DejaVu Sans,sans-serif" font-size="11">\n'
        f'<text x="{left / 2}" y="14" text-anchor="middle" '
        f'textLength="{round(_LETTER * len(_NAME))}">{_NAME}</text>'
        f'<text x="{left + right / 2}" {place}>{escape(said)}</text>\n</g>\n</svg>\n'
    )


def _said(outcome: GateOutcome) -> tuple[str, str]:
    counts = count_by_verdict(outcome.specs)
    for verdict, colour in (("refuted", _BAD), ("inconclusive", _OPEN)):
        if number := counts.get(verdict, 0):
            return f"{number} {verdict}", colour
    if outcome.broken:
        return f"{len(outcome.broken)} not fulfilled", _BAD
    proved = counts.get("proved", 0)
    return f"{proved} proved", _GOOD if proved else _OPEN
