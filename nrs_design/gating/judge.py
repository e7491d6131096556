"""What the gate asks of a design beside its proof: goals, and limits of scenarios."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from nrs_design.errors import DesignError
from nrs_design.gating.examine import Examiner
from nrs_design.gating.obligations import Obligation
from nrs_design.pipeline.analysis import run_judgement
from nrs_design.pipeline.certification import Result
from nrs_design.progress import Progress

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis


def judge_margins(
    result: Result, examiner: Examiner, progress: Progress
) -> tuple[DesignAnalysis | None, tuple[Obligation, ...]]:
    """Analyze a design, and return how its goals and stiffness ranges end: NRS103, NRS106, NRS112.

    No analysis for given matrices, and where a nominal loop is unstable.
    """
    if result.designed is None:
        return None, ()
    progress("margins")
    try:
        analysis = run_judgement(result.designed)
    except DesignError as error:
        return None, (examiner.no_margins(error),)
    judged = (examiner.stiffness_ranges, examiner.goals, examiner.responses)
    return analysis, tuple(item for judge in judged for item in judge(analysis))


def judge_scenarios(result: Result, examiner: Examiner, progress: Progress) -> Iterator[Obligation]:
    """Simulate the scenarios that have limits, and yield how they end."""
    if result.designed is None:
        return
    limited = [n for n, one in result.designed.spec.scenarios.items() if one.limits is not None]
    if not limited:
        return
    from nrs_design.pipeline.scenarios import Runs, run_scenarios

    for name in limited:
        progress(f"scenario {name}")
        try:
            (simulated,) = run_scenarios(result.designed, Runs((name,)))
        except DesignError as error:
            yield examiner.no_scenario(name, error)
        else:
            yield from examiner.scenario(name, simulated)
