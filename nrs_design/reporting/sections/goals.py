"""Goals beside the worst values reached and the proofs, and warnings."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from nrs_design.certificates.goals import certified_goals
from nrs_design.design.goals import Achieved
from nrs_design.design.measures import MEANING, GoalStanding
from nrs_design.reporting.document import Block, Bullets, Linked, Paragraph, Section, State, Table
from nrs_design.reporting.sections.places import linked, locate_contact
from nrs_design.reporting.sections.titles import GOALS
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.goals import OF_THE_CERTIFICATE

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.pipeline.certification import Result
    from nrs_design.spec import LoadedSpec, Spec

_CERTIFIED = ("Goal", "Wanted", "What the certificate shows", "Result")
_PROOFS = (
    "These goals are for all controllers together, and what is proved decides them, in exact "
    "arithmetic, as in nrs-design gate (NRS108). One that is not proved is not refuted: more may "
    "be true than the certificate shows. The gate fails on it all the same."
)
_UNCOMPUTED = (
    "Goals for margins and errors are not computed: they exist only where the nominal loops are "
    "stable."
)

_COLUMNS = ("Controller", "Measure", "Goal", "Worst", "At", "Result")


def goals_section(result: Result, analysis: DesignAnalysis | None) -> Section | None:
    """Compare goals with the worst values reached and with the proofs, and list warnings.

    None where nothing is measured and no goal asks for a proof.
    """
    blocks = [*_measured(result, analysis), *_certified(result)]
    return Section(GOALS, tuple(blocks)) if blocks else None


def judged_goals(result: Result, analysis: DesignAnalysis | None) -> tuple[State, str]:
    """Return the common state of all goals of a spec, and its summary."""
    proofs = tuple(certified_goals(result.loaded.spec, result.certificate))
    measured = () if analysis is None else analysis.measured
    goals = [found for item in measured for found in item.judged_goals]
    missed = sum(found.standing is GoalStanding.MISSED for found in goals)
    unjudged = sum(found.standing is GoalStanding.NOT_JUDGED for found in goals)
    open_ = [goal.key for goal in proofs if not goal.met]
    uncomputed = analysis is None and _are_measured(result.loaded.spec)
    summary = []
    if uncomputed:
        summary.append("not computed: a nominal loop is unstable")
    elif missed:
        summary.append(f"{missed} of {len(goals)} missed (floating point)")
    elif goals and not unjudged:
        summary.append(f"all {len(goals)} met")
    if unjudged and not uncomputed:
        summary.append(f"{unjudged} of {len(goals)} not judged between the corners of ranges")
    proved_keys = [goal.key for goal in proofs if goal.met]
    for verdict, keys in (("NOT proved", open_), ("proved", proved_keys)):
        if keys:
            summary.append(f"{verdict}: {', '.join(dict.fromkeys(keys))}")
    if not summary:
        return State.UNKNOWN, "no goals set"
    state = State.DOUBTFUL if open_ or uncomputed or unjudged else State.GOOD
    return State.BAD if missed else state, "; ".join(filter(None, summary))


def _are_measured(spec: Spec) -> bool:
    """Tell whether a spec has goals that the margins of its controllers decide."""
    if not isinstance(spec, InteractionDesignSpec):
        return False
    given = {key for key, _ in spec.goals.given()} if spec.goals is not None else set()
    return bool(given - OF_THE_CERTIFICATE) or any(
        controller.goals is not None for controller in spec.controllers.values()
    )


def _measured(result: Result, analysis: DesignAnalysis | None) -> Iterator[Block]:
    designed = result.designed
    if analysis is None and _are_measured(result.loaded.spec):
        yield Paragraph(_UNCOMPUTED)
    if designed is None or analysis is None:
        return
    rows = tuple(
        _row(designed.loaded, item.name, found)
        for item in analysis.measured
        for found in item.judged
    )
    if not rows:
        return
    yield Paragraph(" ".join(MEANING))
    yield Table("Goals and worst values", _COLUMNS, rows)
    doubts = tuple(linked(designed.loaded, str(doubt), *doubt.at) for doubt in analysis.warnings)
    if doubts:
        yield Bullets("Warnings", doubts)


def _place(loaded: LoadedSpec, controller: str, goal: str) -> tuple[str, ...]:
    """Return the key path of a goal: of the controller, else of the whole spec."""
    spec = loaded.spec
    assert isinstance(spec, InteractionDesignSpec), "it has controllers"
    own_goals = spec.controllers[controller].goals
    is_own = own_goals is not None and getattr(own_goals, goal, None) is not None
    return ("controllers", controller, "goals", goal) if is_own else ("goals", goal)


def _certified(result: Result) -> Iterator[Block]:
    loaded = result.loaded
    rows = tuple(
        (
            goal.key,
            linked(loaded, goal.wanted, *goal.place),
            goal.said,
            "proved" if goal.met else "NOT PROVED",
        )
        for goal in certified_goals(loaded.spec, result.certificate)
    )
    if rows:
        yield Paragraph(_PROOFS)
        yield Table("Goals that the certificate must show", _CERTIFIED, rows)


def _row(loaded: LoadedSpec, name: str, achievement: Achieved) -> tuple[str, ...]:
    measure = achievement.measure
    goal, result = "–", "no goal"
    location = achievement.where.replace("*", "·").replace("^2", "²")
    if achievement.goal is not None:
        place = loaded.place(*_place(loaded, name, measure.goal))
        goal = Linked(measure.goal_text(achievement.goal), place.line)
        result = achievement.standing.text
    return (
        name,
        measure.title,
        goal,
        linked(loaded, achievement.text, "controllers", name),
        linked(loaded, location, *locate_contact(loaded, achievement.where)),
        result,
    )
