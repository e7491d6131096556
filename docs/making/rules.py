"""Every rule and verdict, as ``explain`` prints them."""

from __future__ import annotations

from nrs_design.gating.rules import RULES, WORDS


def rules_page() -> str:
    """Describe every rule and verdict."""
    lines = ["# Rules and verdicts", "", "`nrs-design explain RULE` prints the same.", ""]
    for rule in RULES.values():
        lines += [f"## {rule.id}: {rule.title}", "", rule.explanation, ""]
        lines += [f"**What to do:** {rule.remedy}", ""]
    for word in WORDS.values():
        lines += [f"## {word.word}", "", word.explanation, "", f"**What to do:** {word.remedy}", ""]
    return "\n".join(lines)
