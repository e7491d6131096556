"""What a goal of the proof asks a spec to declare: a goal `delay` is proved, so it is declared."""

from __future__ import annotations

from dataclasses import replace
from math import ceil
from typing import TYPE_CHECKING

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import Designed, run_design
from nrs_design.pipeline.written_gains import edited
from nrs_design.spec.sampling import LONGEST_DELAY
from nrs_design.spec.spec_document import SpecDocument

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis


def wanted_age(designed: Designed) -> int | None:
    """Return the age of the force, in samples, that the goal `delay` asks for beyond the declared.

    None where the declared ages reach the goal.
    """
    goals, sampling = designed.spec.goals, designed.spec.sampling
    delay = None if goals is None else goals.delay
    if delay is None or sampling is None or sampling.oldest >= delay.exact:
        return None
    age = ceil(delay.exact / sampling.outer)
    if age > LONGEST_DELAY:
        raise DesignError(
            f"the goal delay, {delay.text}, is {age} samples, and at most {LONGEST_DELAY} are "
            "modelled",
            remedy="ask for a shorter delay, or sample less often",
            at=("goals", "delay"),
        )
    return age


def with_delay(
    designed: Designed, analysis: DesignAnalysis, age: int
) -> tuple[Designed, DesignAnalysis]:
    """Return a spec that declares ages of the force in samples up to this one, and its problems.

    What its own gains achieve is not asked: others are to be chosen, and these may be unstable.
    """
    from nrs_design.design.laws.impedance import impedance_problem, requirement_of
    from nrs_design.design.laws.law import Task

    sampling = designed.spec.sampling
    assert sampling is not None, "a delay is of samples"

    def change(document: SpecDocument) -> None:
        document.put(document.root["sampling"], "delay", [min(sampling.delay[0], age), age])

    found = run_design(edited(designed.loaded, change))
    assert found is not None, "as it was one"
    task, items = Task(found.spec, found.plant, found.design.motion), []
    for item in analysis.impedance:
        requirement = requirement_of(task, item.given)
        problem = impedance_problem(task, item.given, requirement)
        items.append(replace(item, problem=problem, requirement=requirement))
    return found, replace(analysis, measured=(*items, *analysis.tuned))
