"""What a goal `delay` asks of a proof: to hold for an older force than the spec declares."""

from __future__ import annotations

from dataclasses import replace
from math import ceil
from typing import TYPE_CHECKING

from nrs_design.errors import DesignError
from nrs_design.pipeline.design import Designed
from nrs_design.proof.text import exact_text
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.sampling import LONGEST_DELAY

if TYPE_CHECKING:
    from nrs_design.spec import InteractionDesignSpec


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


def for_goal(designed: Designed) -> Designed | None:
    """Return a design whose spec declares what its goal `delay` asks for; None if it does."""
    age = wanted_age(designed)
    return None if age is None else declaring(designed, age)


def declaring(designed: Designed, age: int) -> Designed:
    """Return a design whose spec declares ages of the force up to this one, in samples."""
    from nrs_design.certificates.ages import declaring_ages

    assert designed.spec.sampling is not None, "a delay is of samples"
    least = designed.spec.sampling.delay[0]
    return _with_spec(designed, declaring_ages(designed.spec, (min(least, age), age)))


def wanting(designed: Designed, age: int) -> Designed:
    """Return a design whose goal `delay` is so many samples."""
    goals, sampling = designed.spec.goals, designed.spec.sampling
    assert goals is not None, "as one is the delay"
    assert sampling is not None, "a delay is of samples"
    text = exact_text(age * sampling.outer)
    delay = Quantity(f"{text} s", age * sampling.outer, "s")
    goals = goals.model_copy(update={"delay": delay})
    return _with_spec(designed, designed.spec.model_copy(update={"goals": goals}))


def _with_spec(designed: Designed, spec: InteractionDesignSpec) -> Designed:
    return replace(designed, loaded=replace(designed.loaded, spec=spec), spec=spec)
