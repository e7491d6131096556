"""Printing of goals and assumptions, for several commands."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.printing import detail, note, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.proof.text import counted

if TYPE_CHECKING:
    from nrs_design.api.optimum import Optimum
    from nrs_design.design.analysis import AbstractControllerAnalysis
    from nrs_design.pipeline.certification import Result


# Number of mode names that -v prints; --json prints all names.
MODE_NAMES = 10


def _print_goals(name: str, items: Iterable[AbstractControllerAnalysis]) -> None:
    """Print each goal of the spec with its worst achieved value; nothing without goals."""
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


def print_granted(result: Result) -> None:
    """Print all assumptions, or their number and the effects that are not modelled."""
    from nrs_design.certificates.catalogue import sentences

    certification = result.certification
    assumptions, names = certification.granted, [mode.name for mode in certification.system.modes]
    detail("  taken for granted (nrs-design report says how to test each):")
    for text in sentences(assumptions):
        detail(f"    - {text}")
    detail(f"  common quadratic function: {certification.common_quadratic}")
    remainder = f" and {len(names) - MODE_NAMES} more" if len(names) > MODE_NAMES else ""
    detail(f"  {counted(len(names), 'mode')}: {', '.join(names[:MODE_NAMES])}{remainder}")
    if assumptions and not wants_details():
        effects = "; ".join(result.omits)
        omission = f"; not modelled: {effects}" if effects else ""
        say(f"  takes {counted(len(assumptions), 'thing')} for granted (-v){omission}")


def design_answer(
    optimum: Optimum,
    items: Iterable[AbstractControllerAnalysis],
    facts: Callable[[], dict[str, Any]],
    print_design: Callable[[], object],
    *,
    proved: bool = True,
    prints_goals: bool = False,
) -> Answer:
    """Return the answer of a command that shows a design: the worst of it, goals, what is doubtful.

    The exit code is 1 if an item misses a goal, or one that needs a proof is not `proved`.
    `prints_goals`: `print_design` prints the proved goals of a certificate.
    """
    from nrs_design.spec.goals import OF_THE_CERTIFICATE

    spec, doubts = optimum.designed.spec, optimum.analysis.warnings
    given = () if prints_goals or spec.goals is None else (key for key, _ in spec.goals.given())
    left = [key for key in given if key in OF_THE_CERTIFICATE]

    def show_all() -> None:
        for doubt in doubts[:1]:
            note(f"warning: {doubt}")
        print_design()
        _print_goals(spec.name, items)
        if left:
            keys = ", ".join(left)
            say(f"Not judged here: {keys}. A proof decides: nrs-design certify-switching.")
        for doubt in doubts[1:]:
            note(f"warning: {doubt}")

    return Answer(
        lambda: (
            optimum.designed.loaded.facts | facts() | {"warnings": [str(doubt) for doubt in doubts]}
        ),
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
