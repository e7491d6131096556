"""What `optimize` and `tune` say about goals."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.printing import detail, note, say
from nrs_design.cli.tables import print_table

if TYPE_CHECKING:
    from nrs_design.design.analysis import AbstractControllerAnalysis, DesignAnalysis
    from nrs_design.pipeline.design import Designed
    from nrs_design.spec import InteractionDesignSpec


def _print_goals(name: str, items: Iterable[AbstractControllerAnalysis]) -> None:
    """Print what the spec asks for beside what is achieved at worst; nothing without goals."""
    from nrs_design.design.measures import MEANING, computed

    rows = [
        [
            item.name,
            found.measure.title,
            found.measure.goal_text(found.goal),
            found.text,
            found.where,
            found.standing.text,
        ]
        for item in items
        for found in item.judged_goals
        if found.goal is not None
    ]
    if rows:
        columns = ["controller", "goal", "wanted", "worst", "at", ""]
        print_table(f"{name}: goals", columns, rows)
        for line in (*MEANING[:-1], *computed({item.name: item.proved_titles for item in items})):
            detail(line)


def print_responses(analysis: DesignAnalysis) -> None:
    """Print what is proved of frequency responses; nothing without goals for them."""
    from nrs_design.design.measures import RESPONSE_MEANING

    judged = [(item.name, found) for item in analysis.impedance for found in item.responses]
    for name, found in judged:
        say(f"{name}: {found.key}, {found.wanted}: {found.ends.upper()}: {found.said}")
    if judged:
        detail(RESPONSE_MEANING)


def design_answer(
    designed: Designed,
    analysis: DesignAnalysis,
    items: Iterable[AbstractControllerAnalysis],
    facts: Callable[[], dict[str, Any]],
    show: Callable[[], object],
    *,
    proved: bool = True,
    judged: bool = False,
) -> Answer:
    """Return the answer of a command that shows a design: the worst of it, goals, what is doubtful.

    The exit code is 1 if an item misses a goal, or one that needs a proof is not `proved`.
    `judged`: `show` says what is proved of the goals of a certificate.
    """
    loaded, spec, doubts = designed.loaded, designed.spec, analysis.warnings

    def show_all() -> None:
        for doubt in doubts[:1]:
            note(f"warning: {doubt}")
        show()
        _print_goals(spec.name, items)
        if not judged:
            _say_unjudged(spec)
        for doubt in doubts[1:]:
            note(f"warning: {doubt}")

    return Answer(
        lambda: loaded.facts | facts() | {"warnings": [str(doubt) for doubt in doubts]},
        show_all,
        _exit_code(items, proved=proved),
    )


def _exit_code(items: Iterable[AbstractControllerAnalysis], *, proved: bool) -> int:
    """Return 1 where a goal is missed or one of the proof is not proved, 3 where one is open."""
    from nrs_design.design.measures import GoalStanding

    found = {one.standing for item in items for one in item.judged_goals}
    if not proved or GoalStanding.MISSED in found:
        return exit_codes.REFUTED
    return exit_codes.INCONCLUSIVE if GoalStanding.NOT_JUDGED in found else exit_codes.PROVED


def _say_unjudged(spec: InteractionDesignSpec) -> None:
    """Print which goals no number of a design decides; nothing without them."""
    from nrs_design.spec.goals import OF_THE_CERTIFICATE

    given = () if spec.goals is None else (key for key, _ in spec.goals.given())
    keys = [key for key in given if key in OF_THE_CERTIFICATE]
    if keys:
        say(f"Not judged here: {', '.join(keys)}. A proof decides: nrs-design certify-switching.")
