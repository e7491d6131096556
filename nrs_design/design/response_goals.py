"""Goals for frequency responses, beside what is proved of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction

from nrs_design.axis import unit
from nrs_design.controllers.laws import CompliantLaw
from nrs_design.design.displayed_response import (
    LargestResponse,
    largest_impedance,
    largest_tracking_error,
)
from nrs_design.loop.cut_loop import AbstractAxis, ContinuousAxis
from nrs_design.models.contact import Elastic, KelvinVoigt
from nrs_design.models.contact.environment import Environment
from nrs_design.models.interval import Interval
from nrs_design.models.plant import Plant
from nrs_design.proof.bounds import rounded_down, rounded_up
from nrs_design.spec import InteractionDesignSpec
from nrs_design.spec.goals import GoalsSpec, ResponseGoal

# Keys of the goals.
TRANSPARENCY, ACCURACY = "transparency", "accuracy"
_TITLES = {TRANSPARENCY: "the displayed impedance", ACCURACY: "the tracking error"}


@dataclass(frozen=True)
class JudgedResponse:
    """A goal for a frequency response of one controller, and what is proved of it."""

    key: str  # Of the goal in the spec
    title: str  # What is bounded
    limit: Fraction  # In SI
    wanted: str  # In words
    unit: str  # Of the limit; empty for a share
    found: LargestResponse | None  # None where it is not judged
    why_not: str = ""  # Why it is not judged
    units: Mapping[str, str] = field(default_factory=dict)  # Of the parameters

    @property
    def above(self) -> Fraction | None:
        """What the response is proved not to exceed, if a bound was shown."""
        return None if self.found is None else self.found.above

    @property
    def below(self) -> Fraction | None:
        """What it is proved to reach somewhere, if it is judged."""
        return None if self.found is None else self.found.below

    @property
    def proved(self) -> bool:
        """Whether the response is proved to stay within its limit."""
        return self.above is not None and self.above <= self.limit

    @property
    def refuted(self) -> bool:
        """Whether it is proved to exceed its limit."""
        return self.below is not None and self.below > self.limit

    @property
    def ends(self) -> str:
        """How the goal ends, in a word or two."""
        if self.found is None:
            return "not judged"
        return "proved" if self.proved else "refuted" if self.refuted else "undecided"

    @property
    def said(self) -> str:
        """What is shown, numbers rounded to their safe side."""
        if self.found is None:
            return f"not judged: {self.why_not}"
        found = self.found
        if self.refuted:
            return f"{self.title} is {rounded_down(found.below, self.unit)} {self.where}"
        if found.above is None:
            return f"no bound on {self.title} was shown"
        least = f"at least {rounded_down(found.below, self.unit)} {self.where}"
        return f"{self.title} is at most {rounded_up(found.above, self.unit)}; {least}"

    @property
    def where(self) -> str:
        """At which frequency and parameters the largest value was found."""
        assert self.found is not None, "there is a value"
        at = [f"{self.found.omega:.6g} rad/s"]
        at += [
            f"{name} = {float(value):.6g} {self.units[name]}"
            for name, value in self.found.at.items()
        ]
        return f"at {', '.join(at)}"


def judged_responses(
    spec: InteractionDesignSpec,
    goals: Mapping[str, ResponseGoal],
    axis: AbstractAxis | None,
    law: CompliantLaw,
    ranges: Mapping[str, Interval],
    plant: Plant,
) -> Iterator[JudgedResponse]:
    """Yield the goals for frequency responses of a controller, and what is proved of them.

    Ranges are those of ``Km``, ``tau``, ``Mt``, ``Bt`` and ``Kt``, as far as they have any.
    """
    for key, goal in goals.items():
        touched = None if goal.environment is None else plant.environment(goal.environment)
        where = f"in contact with {goal.environment}" if touched else "in free motion"
        found = _found(spec, key, goal, axis, law, ranges, touched)
        yield JudgedResponse(
            key=key,
            title=f"{_TITLES[key]} {where}",
            limit=goal.limit,
            wanted=f"at most {goal.limit_text} from {goal.band[0].text} to {goal.band[1].text}",
            unit=unit("N*m*s/rad") if key == TRANSPARENCY else "",
            found=None if isinstance(found, str) else found,
            why_not=found if isinstance(found, str) else "",
            units={
                **{"Km": f"{unit('rad/s')}/{spec.command}", "tau": "s", "Mt": unit("kg*m^2")},
                **dict.fromkeys(("Bt", "b"), unit("N*m*s/rad")),
                **dict.fromkeys(("Kt", "k"), unit("N*m/rad")),
            },
        )


def response_goals(*given: GoalsSpec | None) -> dict[str, ResponseGoal]:
    """Return goals for frequency responses by key; the later ones replace those before."""
    found = (goals for goals in given if goals is not None)
    return {
        key: goal
        for goals in found
        for key in (TRANSPARENCY, ACCURACY)
        if (goal := getattr(goals, key)) is not None
    }


def _found(
    spec: InteractionDesignSpec,
    key: str,
    goal: ResponseGoal,
    axis: AbstractAxis | None,
    law: CompliantLaw,
    ranges: Mapping[str, Interval],
    touched: Environment | None,
) -> LargestResponse | str:
    """Bound a response, or say why that is not done."""
    band = goal.band[0].not_above, goal.band[1].not_below
    if spec.sampling is not None or not isinstance(axis, ContinuousAxis):
        return "the law is sampled"
    if spec.late_at is not None:
        return "commands are late"
    if key == TRANSPARENCY:
        found = largest_impedance(axis, law, ranges, band, goal.limit)
    elif touched is not None and (
        touched.law not in (Elastic, KelvinVoigt) or touched.preloaded or touched.each_losable
    ):
        return f"{touched.name} is neither elastic nor Kelvin-Voigt for every deflection"
    else:
        box = {**ranges, **(touched.parameters if touched else {})}
        contact = touched is not None
        found = largest_tracking_error(axis, law, box, band, goal.limit, in_contact=contact)
    return found or "the loop is not shown to be stable at every value of the ranges"
