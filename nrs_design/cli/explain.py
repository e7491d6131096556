"""``nrs-design explain``: meaning and remedy of a rule or verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import say
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from nrs_design.gating.rules import Rule, Word


@command("explain")
def explain(
    rule: Annotated[
        str | None, typer.Argument(metavar="[RULE]", help="A rule (NRS102) or verdict (refuted).")
    ] = None,
) -> Answer:
    """Explain a rule or a verdict; without one, list them all.

    Example: nrs-design explain NRS102
    """
    from dataclasses import asdict

    from nrs_design.gating.rules import RULES, WORDS

    if rule is None:
        rules, words = list(RULES.values()), list(WORDS.values())
        facts = {"rules": [*map(asdict, rules)], "verdicts": [*map(asdict, words)]}
        return Answer(lambda: facts, lambda: _list(rules, words))
    entry = RULES.get(rule.upper()) or WORDS.get(rule.lower())
    if entry is None:
        raise NrsDesignError(
            f"there is no rule or verdict {rule!r}",
            remedy="`nrs-design explain` without one lists them",
        )
    return Answer(lambda: asdict(entry), lambda: _explain(entry))


def _list(rules: list[Rule], words: list[Word]) -> None:
    for rule in rules:
        say(f"{rule.id}  {rule.title}")
    say()
    say("Verdicts: " + ", ".join(word.word for word in words))
    say("nrs-design explain RULE says what one of them means, and what to do.")


def _explain(entry: Rule | Word) -> None:
    say(entry.heading)
    for heading, text in (("Meaning", entry.explanation), ("What to do", entry.remedy)):
        say()
        say(heading)
        say(f"  {text}", hanging=0)
