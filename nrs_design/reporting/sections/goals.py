"""Goals: what is asked for, what is reached at worst, and what is doubtful."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.design.goals import Achieved
from nrs_design.design.measures import MEANING
from nrs_design.reporting.document import Block, Bullets, Paragraph, Section, Table
from nrs_design.spec import InteractionDesignSpec, doubt_spec

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis

_COLUMNS = ("Controller", "Measure", "Goal", "Worst", "At", "Result")


def goals_section(spec: InteractionDesignSpec, analysis: DesignAnalysis) -> Section:
    """Set what is reached beside the goals, and list the warnings."""
    rows = tuple(_row(item.name, found) for item in analysis.measured for found in item.achieved)
    table = Table("Goals and worst values", _COLUMNS, rows)
    blocks: list[Block] = [Paragraph(" ".join(MEANING)), table]
    doubts = tuple(map(str, (*doubt_spec(spec), *analysis.warnings)))
    if doubts:
        blocks.append(Bullets("Warnings", doubts))
    return Section("Design goals", tuple(blocks))


def goal_facts(analysis: DesignAnalysis | None) -> tuple[tuple[str, str], ...]:
    """Return for the head of the report how many goals are missed."""
    if analysis is None or not analysis.measured:
        return ()
    goals = [f for item in analysis.measured for f in item.achieved if f.goal is not None]
    missed = sum(not found.met for found in goals)
    if not goals:
        return (("Design goals", "no goals set"),)
    return (("Design goals", f"{missed} of {len(goals)} MISSED" if missed else "all met"),)


def _row(name: str, found: Achieved) -> tuple[str, ...]:
    measure = found.measure
    goal, result = "–", "no goal"
    if found.goal is not None:
        goal = measure.goal_text(found.goal)
        result = "met" if found.met else "MISSED"
    return (name, measure.title, goal, measure.text(found.value), _pretty(found.where), result)


def _pretty(text: str) -> str:
    return text.replace("*", "·").replace("^2", "²")
