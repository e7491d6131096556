"""What `optimize` and `tune` say about goals."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.printing import detail, note, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.facts.spec import spec_facts
from nrs_design.proof.bounds import lower_float, upper_float

if TYPE_CHECKING:
    from nrs_design.design.analysis import (
        AbstractControllerAnalysis,
        DesignAnalysis,
        ImpedanceAnalysis,
    )
    from nrs_design.design.goals import Achieved
    from nrs_design.pipeline import Designed
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
            "met" if found.met else "MISSED",
        ]
        for item in items
        for found in item.judged
        if found.goal is not None
    ]
    if rows:
        columns = ["controller", "goal", "wanted", "worst", "at", ""]
        print_table(f"{name}: goals", columns, rows)
        for line in (*MEANING[:-1], *computed({item.name: item.proved_titles for item in items})):
            detail(line)


def responses_summary(item: ImpedanceAnalysis) -> list[dict[str, Any]]:
    """Return the goals for frequency responses, and what is proved of them, in SI units."""
    return [
        {
            "goal": found.key,
            "wanted": found.wanted,
            "limit": float(found.limit),
            "at_most": None if found.above is None else upper_float(found.above),
            "at_least": None if found.below is None else lower_float(found.below),
            "unit": found.unit,
            "shown": found.said,
            "status": found.ends,
        }
        for found in item.responses
    ]


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
    marked: bool = False,
) -> Answer:
    """Return the answer of a command that shows a design: with goals and with what is doubtful.

    Parameters
    ----------
    designed, analysis
        The spec, and what its design achieves.
    items : iterable of AbstractControllerAnalysis
        The controllers that the command is about; its exit code is 1 if one misses a goal.
    facts, show : callable
        Return the content of the JSON document; print the text.
    proved : bool
        Whether all goals are proved that need a proof of the design; else the exit code is 1, too.
    judged : bool
        Whether `show` says what is proved of the goals of a certificate.
    marked : bool
        Whether it marks what is unusual.
    """
    from nrs_design.spec import doubt_spec

    loaded, spec = designed.loaded, designed.spec
    doubts = (*doubt_spec(spec), *analysis.warnings)

    def show_all() -> None:
        show()
        _print_goals(spec.name, items)
        if not judged:
            _say_unjudged(spec)
        for doubt in doubts:
            if wants_details() or not (marked and doubt.flagged):
                note(f"warning: {doubt}")

    return Answer(
        lambda: spec_facts(loaded) | facts() | {"warnings": [str(doubt) for doubt in doubts]},
        show_all,
        exit_codes.unless(
            not proved or any(not found.met for item in items for found in item.achieved)
        ),
    )


def _say_unjudged(spec: InteractionDesignSpec) -> None:
    """Print which goals no number of a design decides; nothing without them."""
    from nrs_design.spec.goals import OF_THE_CERTIFICATE

    given = () if spec.goals is None else (key for key, _ in spec.goals.given())
    keys = [key for key in given if key in OF_THE_CERTIFICATE]
    if keys := keys + ["limits.contact"] * bool(spec.limits.contact):
        say(f"Not judged here: {', '.join(keys)}. A proof decides: nrs-design certify-switching.")


def goals_summary(item: AbstractControllerAnalysis) -> list[dict[str, Any]]:
    """Return everything that was measured, with its goal if there is one, in SI units."""
    return [_summary(found) for found in item.judged]


def _safe(found: Achieved) -> float | None:
    """Return what is proved, rounded to its unfavorable side."""
    if found.proved is None:
        return None
    return upper_float(found.proved) if found.measure.upper else lower_float(found.proved)


def _summary(found: Achieved) -> dict[str, Any]:
    measure = found.measure
    return {
        "goal": measure.goal,
        "wanted": found.goal,
        # JSON has no infinity: null is a margin that nothing limits, or an error without bound; or
        # what is not computed, as `at` then says.
        "worst": found.value if math.isfinite(found.value) else None,
        # What no constant values in the ranges are worse than; null is not shown.
        "proved": _safe(found),
        "unit": measure.si_unit,
        "at": found.where,
        "status": None if found.goal is None else "met" if found.met else "missed",
    }
