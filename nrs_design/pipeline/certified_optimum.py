"""The cheapest gains whose proof meets the goals of a certificate: all controllers jointly.

The cost is that of `nrs_design.design.impedance_optimum`, summed over the controllers. What a
proof shows is known at a design, with its slope (`nrs_design.search.rate_slope`); between two
designs it is taken as linear in the logarithms of the gains, within a region that shrinks where
that was wrong. Gains are rounded to the digits that ship, and the proof of these is searched and
checked as that of any spec.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.axis import unit
from nrs_design.certificates.certificate import Verdict
from nrs_design.certificates.goals import STEERING, certified_goals
from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import Result, assemble_spec, run_certification
from nrs_design.pipeline.design import Designed, placed
from nrs_design.pipeline.free_gains import Array, FreeGains, gain_branches, has_free_gains, in_order
from nrs_design.pipeline.goal_ranges import wanted_age, with_delay
from nrs_design.pipeline.proof_constraints import NOTHING, ROOM, DesignEvaluator, constraints_of
from nrs_design.pipeline.written_gains import Written
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import rounded_down

if TYPE_CHECKING:
    # What was certified, what ships of the free gains, and the point.
    Proved = tuple[Result, Written, Array]
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.trust_region import ConstrainedOptimum, ConstrainedProblem, Evaluation
    from nrs_design.spec import Quantity
    from nrs_design.spec.spec_document import SpecDocument

# Roundings that are proved at most.
MOST_ROUNDINGS = 4
# Where the proof falls short, there is more room for roundings.
ROOMS = (ROOM, (4e-3, 1.2e-2), (2e-2, 4e-2))
# A goal that is missed by no more than this share may be met by rounding.
NEAR = 5e-3
# What costs less does not bind.
LEAST_PRICE = 1e-4


@dataclass(frozen=True, slots=True)
class SteeredGoal:
    """A goal of the certificate that gains were chosen by."""

    key: str  # In the spec
    wanted: Fraction  # In SI units
    binds: bool  # Whether gains would be cheaper without it
    # What one more in SI units costs, in first order; None where the goal does not bind, or where
    # what it asks for is counted in whole samples.
    price: float | None

    @property
    def price_of_a_percent(self) -> float | None:
        """What it costs to ask for one per cent more."""
        return None if self.price is None else float(self.wanted) / 100 * self.price


@dataclass(frozen=True, slots=True)
class CertifiedOptimum:
    """The gains that were found, with their proof."""

    result: Result  # Of the spec with these gains; its certificate has been checked exactly
    gains: Written  # What ships of the free ones
    cost: float  # Summed over the controllers
    free_cost: float  # The least without goals of the certificate
    free_rate: float  # The best decay rate there in floating point, 1/s
    goals: tuple[SteeredGoal, ...]
    tried: int  # Designs whose rate was found
    # Gains that `design.free` names and that are on a bound, and on which.
    at_bounds: tuple[tuple[str, str], ...] = ()


def steering_goals(designed: Designed, analysis: DesignAnalysis) -> tuple[str, ...]:
    """Return the goals that gains can be steered by; none where no gain is free."""
    goals = designed.spec.goals
    given = [] if goals is None else [key for key, _ in goals.given()]
    return tuple(key for key in STEERING if key in given and has_free_gains(designed, analysis))


def run_certified_optimum(
    designed: Designed,
    analysis: DesignAnalysis,
    progress: Progress = silent,
    name: str | None = None,
) -> CertifiedOptimum:
    """Choose the free gains of all controllers at once, with their proof; at least one goal steers.

    Where a mass may be zero, the best without masses and the best with them are compared: without,
    a force acts at once, else a sample later. A goal `delay` beyond what the spec declares is
    declared in the spec that is proved. Where none are proved, the `DesignError` names the nearest.
    """
    with placed(designed.loaded):
        if (age := wanted_age(designed)) is None:
            return _cheapest(designed, analysis, progress, name)
        try:
            return _cheapest_at(designed, analysis, age, progress, name)
        except DesignError as error:
            raise _too_old(designed, analysis, age, progress, error) from error


def cheapest_gains(
    gains: FreeGains, progress: Progress, name: str | None = None
) -> CertifiedOptimum:
    """Choose the gains of one branch, with their proof."""
    return _Search(gains, progress, name).run()


def meets_goals(result: Result) -> bool:
    """Tell whether a spec is proved, with the goals that steer, for its own ages of the force."""
    goals = certified_goals(result.loaded.spec, result.certificate)
    proved = result.certification.verdict is Verdict.PROVED
    return proved and all(goal.met for goal in goals if goal.key in STEERING[:-1])


def check_steerable(designed: Designed) -> None:
    """Refuse what no form for all modes could prove, whatever the gains."""
    from nrs_design.search.rate_slope import may_have_slope

    if not may_have_slope(assemble_spec(designed.loaded, designed)):
        raise DesignError(
            "gains are chosen with their proof only where one quadratic function may be one: not "
            "with two periods, rules that lead through unstable modes, or one state",
            remedy="optimize without a goal of the proof, and let certify-switching try others",
            at=("goals",) if designed.spec.goals is not None else (),
        )


def _cheapest(
    designed: Designed, analysis: DesignAnalysis, progress: Progress, name: str | None
) -> CertifiedOptimum:
    """Search all branches of gains, and return the cheapest."""
    check_steerable(designed)
    found, missed = [], []
    for gains in gain_branches(designed, analysis):
        try:
            found.append(cheapest_gains(gains, progress, name))
        except DesignError as error:
            missed.append(error)
    if not found:
        raise missed[0]
    return min(found, key=lambda item: item.cost)


def _cheapest_at(
    designed: Designed,
    analysis: DesignAnalysis,
    age: int,
    progress: Progress,
    name: str | None = None,
) -> CertifiedOptimum:
    """Do the same of a spec that declares an older force."""
    progress(f"force samples up to {age} periods old")
    return _cheapest(*with_delay(designed, analysis, age), progress, name)


def _too_old(
    designed: Designed,
    analysis: DesignAnalysis,
    age: int,
    progress: Progress,
    error: DesignError,
) -> DesignError:
    """Say up to which age the other goals are reached, where they are not at the one asked for."""
    goals, sampling = designed.spec.goals, designed.spec.sampling
    assert goals is not None, "as one is the delay"
    assert goals.delay is not None
    assert sampling is not None
    low, high, nearest = sampling.delay[1] - 1, age, None  # The declared age is tried as well
    while high - low > 1:
        middle = (low + high) // 2
        try:
            low, nearest = middle, _cheapest_at(designed, analysis, middle, progress)
        except DesignError:
            high = middle
    reached = "nor is what the spec declares"
    if nearest is not None:
        gains = ", ".join(f"{' '.join(key)} = {text}" for key, text in nearest.gains.items())
        reached = (
            f"{rounded_down(low * sampling.outer, 's')} is reached, at a cost of "
            f"{nearest.cost:.4g}, by {gains}"
        )
    return DesignError(
        f"the goal delay, {goals.delay.text}, is not reached; {reached}. Beyond: {error.message}",
        remedy=error.remedy,
        at=("goals", "delay"),
    )


class _Search:
    """The search for the cheapest gains whose proof meets the goals."""

    def __init__(self, gains: FreeGains, progress: Progress, name: str | None) -> None:
        self.gains, self.progress, self.name = gains, progress, name
        self.goals = gains.designed.spec.goals
        given = {key: getattr(self.goals, key, None) for key in STEERING}
        self.wanted: dict[str, Quantity] = {k: v for k, v in given.items() if v is not None}
        self.constraints = constraints_of(self.goals, *ROOMS[0])

    def run(self) -> CertifiedOptimum:
        """Search, round and prove; where the proof falls short, once more with more room."""
        self.progress("free optimum")
        start = free = self.gains.optimum()
        evaluations, free_rate = 0, None
        for rooms in ROOMS:
            self.constraints = constraints_of(self.goals, *rooms)
            problem, first, found = self._minimum(start)
            evaluations += found.evaluations
            if free_rate is None:
                free_rate = self.constraints[0].number(float(first.values[0]))
            if found.last.values.min() <= -NEAR:
                break
            self.progress("proof")
            if (proved := self._proved(found, problem)) is not None:
                prices = found.shadow_prices
                bounds = self.gains.at_bounds(found.last.x)
                return self._optimum(free, free_rate, proved, prices, evaluations, bounds)
            start = found.last.x
        self.progress("proof")
        # Other functions may prove the optimum of the cost alone; nothing binds there.
        if (proved := self._otherwise(free)) is not None:
            nothing = np.zeros(len(self.constraints))
            return self._optimum(free, free_rate or 0.0, proved, nothing, evaluations)
        raise self._unreachable(found.last, in_floats=rooms != ROOMS[0])

    def _minimum(self, start: Array) -> tuple[ConstrainedProblem, Evaluation, ConstrainedOptimum]:
        """Minimize the cost in floating point, also from other starts if that misses a goal."""
        from nrs_design.design.trust_region import ConstrainedProblem, minimize_in_trust_region

        gains = self.gains
        evaluate = DesignEvaluator.of(gains, self.constraints, self.progress).evaluate
        problem = ConstrainedProblem(gains.cost, evaluate, gains.low, gains.high, gains.spared)
        first = evaluate(start, None)
        found = minimize_in_trust_region(problem, first)
        # With more damping, or with less.
        for bound in (gains.high, gains.low):
            if found.last.values.min() > -NEAR:
                break
            other = minimize_in_trust_region(problem, evaluate((start + bound) / 2, None))
            found = max(found, other, key=lambda one: float(one.last.values.min()))
        return problem, first, found

    def _optimum(
        self,
        free: Array,
        free_rate: float,
        proved: Proved,
        prices: Array,
        evaluations: int,
        at_bounds: tuple[tuple[str, str], ...] = (),
    ) -> CertifiedOptimum:
        result, written, x = proved
        return CertifiedOptimum(
            result,
            written,
            self.gains.cost(x),
            self.gains.cost(free),
            free_rate,
            tuple(self._goals(prices)),
            evaluations,
            at_bounds,
        )

    def _goals(self, prices: Array) -> Iterator[SteeredGoal]:
        """Yield the goals that steered, with what they cost."""
        found = {
            constraint.key: (bool(price > LEAST_PRICE), float(price) / constraint.one)
            for constraint, price in zip(self.constraints, prices, strict=True)
        }
        for key, wanted in self.wanted.items():
            # An age is asked for by the modes; what binds is the decay that is to be shown of them.
            binds, price = found.get(key, (found[self.constraints[0].key][0], None))
            yield SteeredGoal(key, wanted.exact, binds, price if binds else None)

    def _proved(self, found: ConstrainedOptimum, problem: ConstrainedProblem) -> Proved | None:
        """Round to the digits that ship, the cheapest first, and prove one that meets the goals."""
        last, near = found.last, []
        for x, written in self.gains.roundings(last.x):
            missed = problem.penalty(last.values + found.jacobian @ (x - last.x))
            if problem.penalty(self.gains.spared(x)) == 0:
                near.append(((missed > 0, problem.cost(x) + missed), x, written))
        for x, written in in_order(near)[:MOST_ROUNDINGS]:
            if (result := self._certified(written)) is not None:
                return result, written, x
        return None

    def _certified(self, written: Written) -> Result | None:
        """Certify the spec with these gains; None if a goal that steers is not met."""
        result = run_certification(self.gains.respecified(written, partial(_named, self.name)))
        return result if meets_goals(result) else None

    def _otherwise(self, free: Array) -> Proved | None:
        """Return the optimum of the cost alone, if its goals are proved."""
        near = [((float(np.abs(x - free).sum()),), x, w) for x, w in self.gains.roundings(free)]
        x, written = in_order(near)[0]
        result = self._certified(written)
        return None if result is None else (result, written, x)

    def _unreachable(self, last: Evaluation, *, in_floats: bool) -> DesignError:
        """Say which goal gains miss, and how near they come."""
        worst = self.constraints[int(np.argmin(last.values))]
        value, wanted = float(last.values.min()), self.wanted.get(worst.key)
        reached = worst.number(value)
        at = ("goals", next(iter(self.wanted), "") if wanted is None else worst.key)
        if in_floats:
            return DesignError(
                f"the goals are reached in floating point, near {self.gains.said(last.x)}, but "
                "roundings take what would prove it",
                remedy="relax a goal a little, or raise design.significant_digits (at most 7)",
                at=at,
            )
        asked = "at all" if wanted is None else f"of {wanted.text}"
        # A rate that is not positive is no decay.
        none = value <= NOTHING or reached <= 0
        reach = "reach none" if none else f"reach {reached:.4g} {unit(worst.unit)}"
        return DesignError(
            f"no gains within the bounds were found that one quadratic function for all modes "
            f"proves with a {worst.title} {asked}: the nearest, {self.gains.said(last.x)}, {reach}",
            remedy="relax the goal, widen the bounds, narrow the ranges, or shorten the delay; or "
            "give the gains, and let certify-switching try other functions",
            at=at,
        )


def _named(name: str | None, document: SpecDocument) -> None:
    if name is not None:
        document.put(document.root, "name", name)
