"""``nrs-design explain``: what a rule or a verdict means, and what to do about it."""

from __future__ import annotations

import shutil
import textwrap
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli.options import Json, Quiet
from nrs_design.cli.printing import print_json, say
from nrs_design.errors import NrsDesignError

if TYPE_CHECKING:
    from nrs_design.gating.rules import Rule, Word

WIDTH = 88


def explain(
    rule: Annotated[
        str | None, typer.Argument(metavar="[RULE]", help="A rule (NRS102) or verdict (refuted).")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Explain a rule or a verdict; without one, list them all.

    Example: nrs-design explain NRS102
    """
    from nrs_design.gating.rules import RULES, WORDS

    if rule is not None and rule.upper() not in RULES and rule.lower() not in WORDS:
        raise NrsDesignError(
            f"there is no rule or verdict {rule!r}",
            remedy="`nrs-design explain` without one lists them",
        )
    if quiet and not as_json:
        return
    if rule is None:
        _list(list(RULES.values()), list(WORDS.values()), as_json=as_json)
    elif rule.upper() in RULES:
        entry = RULES[rule.upper()]
        _explain(f"{entry.id}: {entry.title}", entry, as_json=as_json)
    else:
        _explain(rule.lower(), WORDS[rule.lower()], as_json=as_json)


def _list(rules: list[Rule], words: list[Word], *, as_json: bool) -> None:
    from dataclasses import asdict

    if as_json:
        print_json("explain", {"rules": [*map(asdict, rules)], "verdicts": [*map(asdict, words)]})
        return
    for rule in rules:
        say(f"{rule.id}  {rule.title}")
    say()
    say("Verdicts: " + ", ".join(word.word for word in words))
    say("nrs-design explain RULE says what one of them means, and what to do.")


def _explain(title: str, entry: Rule | Word, *, as_json: bool) -> None:
    from dataclasses import asdict

    if as_json:
        print_json("explain", asdict(entry))
        return
    say(title)
    for heading, text in (("Meaning", entry.explanation), ("What to do", entry.remedy)):
        say()
        say(heading)
        width = min(WIDTH, shutil.get_terminal_size((WIDTH, 24)).columns)
        # An option such as --max-degree is never broken in two.
        wrap = textwrap.TextWrapper(width, break_on_hyphens=False)
        wrap.initial_indent = wrap.subsequent_indent = "  "
        for line in wrap.wrap(text):
            say(line)
