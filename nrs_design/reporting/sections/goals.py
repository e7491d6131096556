"""Goals: what is asked for, what is reached at worst, and what is doubtful."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.design.goals import Achieved
from nrs_design.design.measures import MEANING
from nrs_design.reporting.document import Block, Bullets, Derived, Linked, Paragraph, Section, Table
from nrs_design.reporting.sections.places import contact_at, linked, with_line
from nrs_design.reporting.sections.titles import GOALS
from nrs_design.spec import doubt_spec
from nrs_design.spec.goals import OF_THE_CERTIFICATE

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline import Designed
    from nrs_design.spec import Spec

_COLUMNS = ("Controller", "Measure", "Goal", "Worst", "At", "Result")


def goals_section(designed: Designed, analysis: DesignAnalysis) -> Section:
    """Set what is reached beside the goals, and list the warnings."""
    spec = designed.spec
    rows = tuple(
        _row(designed, item.name, found) for item in analysis.measured for found in item.achieved
    )
    table = Table("Goals and worst values", _COLUMNS, rows)
    blocks: list[Block] = [Paragraph(" ".join(MEANING)), table]
    doubts = tuple(
        with_line(designed.loaded, str(doubt), *doubt.at)
        for doubt in (*doubt_spec(spec), *analysis.warnings)
    )
    if doubts:
        blocks.append(Bullets("Warnings", doubts))
    return Section(GOALS, tuple(blocks))


def goal_facts(spec: Spec, analysis: DesignAnalysis | None) -> tuple[tuple[str, str], ...]:
    """Return for the head of the report how many goals are missed, and what it does not judge."""
    if analysis is None or not analysis.measured:
        return ()
    goals = [f for item in analysis.measured for f in item.achieved if f.goal is not None]
    missed = sum(not found.met for found in goals)
    unjudged = unjudged_goals(spec)
    if not goals:
        return ((GOALS, unjudged or "no goals set"),)
    judged = f"{missed} of {len(goals)} MISSED" if missed else f"all {len(goals)} met"
    said = "; ".join(filter(None, (judged if missed or unjudged else "all met", unjudged)))
    return ((GOALS, Derived(said, GOALS)),)


def unjudged_goals(spec: Spec) -> str:
    """Say which goals are about what is proved, which the gate judges; empty without them."""
    goals = getattr(spec, "goals", None)
    named = [key for key in sorted(OF_THE_CERTIFICATE) if getattr(goals, key, None) is not None]
    return f"{', '.join(named)}: nrs-design gate decides" if named else ""


def _row(designed: Designed, name: str, found: Achieved) -> tuple[str, ...]:
    measure, loaded = found.measure, designed.loaded
    goal, result = "–", "no goal"
    if found.goal is not None:
        goal = Linked(measure.goal_text(found.goal), _line(designed, name, measure.goal))
        result = "met" if found.met else "MISSED"
    return (
        name,
        measure.title,
        goal,
        linked(loaded, measure.text(found.value), "controllers", name),
        linked(loaded, _pretty(found.where), *contact_at(loaded, found.where)),
        result,
    )


def _line(designed: Designed, controller: str, goal: str) -> int:
    """Return the line of the controller's own goal, or of the one for all."""
    own = designed.spec.controllers[controller].goals
    if own is not None and getattr(own, goal, None) is not None:
        return designed.loaded.place("controllers", controller, "goals", goal).line
    return designed.loaded.place("goals", goal).line


def _pretty(text: str) -> str:
    return text.replace("*", "·").replace("^2", "²")
