"""The cheapest gains whose proof meets the goals of a certificate: all controllers jointly.

The cost is summed over the controllers. Between two designs, what a proof shows is taken as linear
in the logarithms of the gains (`nrs_design.search.rate_slope`), within a region that shrinks where
that was wrong. The proof of rounded gains is searched and checked as that of any spec.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.controllers.gains import STEERING
from nrs_design.errors import DesignError
from nrs_design.models.axis import unit
from nrs_design.pipeline.certification import (
    Result,
    assemble_spec,
    certify_design,
    meets_goals,
    search_limits,
)
from nrs_design.pipeline.design import Designed, for_goal, placed, wanted_age
from nrs_design.pipeline.free_gains import (
    Array,
    FreeGains,
    RoundedGains,
    add_problems,
    gain_branches,
)
from nrs_design.pipeline.gain_coordinate import Written
from nrs_design.pipeline.proof_constraints import NOTHING, ROOM, constraints_of, evaluator
from nrs_design.progress import Progress, silent

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.trust_region import ConstrainedOptimum, ConstrainedProblem, Evaluation
    from nrs_design.spec import Quantity

MOST_ROUNDINGS = 4  # Roundings that are proved at most
# Where the proof falls short, there is more room for roundings.
ROOMS = (ROOM, (4e-3, 1.2e-2), (2e-2, 4e-2))
GOAL_TOLERANCE = 5e-3  # A goal that is missed by no more than this share may be met by rounding


@dataclass(frozen=True, slots=True)
class CertifiedOptimum:
    """The gains that were found, with their proof."""

    result: Result  # Of the spec with these gains; its certificate has been checked exactly
    gains: Written  # Free gains, as a spec writes them
    cost: float  # Summed over the controllers
    free_cost: float  # The least without goals of the certificate
    # Best decay rate of these gains in floating point, 1/s; None without a search.
    free_rate: float | None
    tried: int  # Designs whose rate was found
    # Gains that `design.free` names and that are on a bound, and on which.
    at_bounds: tuple[tuple[str, str], ...] = ()


def run_certified_optimum(
    designed: Designed, analysis: DesignAnalysis, progress: Progress = silent
) -> CertifiedOptimum:
    """Choose the free gains as `find_certified_optimum` does, or take those of the least cost.

    These the design has; they are taken where any function proves the goals of them.
    """
    with placed(designed.loaded):
        wanted_age(designed)  # Refuses ages outside the model.
    try:
        return find_certified_optimum(designed, analysis, progress)
    except DesignError:
        if (found := _find_cheapest(designed, analysis, progress)) is not None:
            return found
        raise


def find_certified_optimum(
    designed: Designed, analysis: DesignAnalysis, progress: Progress = silent
) -> CertifiedOptimum:
    """Choose the free gains of all controllers at once, with their proof; at least one goal steers.

    Where a mass may be zero, the best without and with masses are compared: without, a force acts
    at once, else a sample later. Without a proof, the `DesignError` names the nearest.
    """
    with placed(designed.loaded):
        wide, items = designed, analysis
        if (older := for_goal(designed)) is not None:
            wide, items = older, add_problems(older, analysis)
        found, missed = [], []
        for gains in gain_branches(wide, items):
            try:
                found.append(_Search(designed, gains, progress).run())
            except DesignError as error:
                missed.append(error)
        if not found:
            raise missed[0]
        return min(found, key=lambda item: item.cost)


def _find_cheapest(
    designed: Designed, analysis: DesignAnalysis, progress: Progress
) -> CertifiedOptimum | None:
    """Return the gains of the least cost, if any function proves the goals of them."""
    result = certify_design(designed.loaded, designed, progress=progress)
    branches = (one for one in gain_branches(designed, analysis) if one.holds(designed.design))
    gains = next(branches, None)
    if gains is None or not meets_goals(result):
        return None
    one = gains.of(designed.design)
    cost = gains.cost(one.x)
    return CertifiedOptimum(result, one.written, cost, cost, None, 0)


class _Search:
    """The search for the cheapest gains whose proof meets the goals."""

    def __init__(self, given: Designed, gains: FreeGains, progress: Progress) -> None:
        self.given, self.gains, self.progress = given, gains, progress
        self.goals = given.spec.goals
        goals = {key: getattr(self.goals, key, None) for key in STEERING}
        self.wanted: dict[str, Quantity] = {k: v for k, v in goals.items() if v is not None}
        self.constraints = constraints_of(self.goals, *ROOMS[0])

    def run(self) -> CertifiedOptimum:
        """Search, round and prove; where the proof falls short, once more with more room."""
        self.progress("free optimum")
        start = free = self.gains.optimum()
        self._check_steerable()
        evaluations, free_rate = 0, None
        for rooms in ROOMS:
            self.constraints = constraints_of(self.goals, *rooms)
            problem, first, found = self._minimum(start)
            evaluations += found.evaluations
            if free_rate is None:
                free_rate = self.constraints[0].number(float(first.values[0]))
            if found.last.values.min() <= -GOAL_TOLERANCE:
                break
            self.progress("proof")
            if (proved := self._proved(found, problem)) is not None:
                result, one = proved
                return CertifiedOptimum(
                    result,
                    one.written,
                    self.gains.cost(one.x),
                    self.gains.cost(free),
                    free_rate,
                    evaluations,
                    self.gains.at_bounds(found.last.x),
                )
            start = found.last.x
        raise self._unreachable(found.last, in_floats=rooms != ROOMS[0])

    def _check_steerable(self) -> None:
        """Refuse systems without a common form, for any gains."""
        from nrs_design.search.rate_slope import may_have_slope

        wide = self.gains.designed
        if not may_have_slope(assemble_spec(wide.loaded, wide)):
            raise DesignError(
                "gains are chosen with their proof only where one quadratic function may be one: "
                "not with two periods, rules that lead through unstable modes, or one state; and "
                "nothing proves the goals of those of the least cost",
                remedy="relax a goal, or give the gains",
                at=("goals",),
            )

    def _minimum(self, start: Array) -> tuple[ConstrainedProblem, Evaluation, ConstrainedOptimum]:
        """Minimize the cost in floating point, also from other starts if that misses a goal."""
        from nrs_design.design.trust_region import ConstrainedProblem, minimize_in_trust_region

        gains = self.gains
        evaluate = evaluator(gains, self.constraints, self.progress)
        problem = ConstrainedProblem(gains.cost, evaluate, gains.low, gains.high, gains.spared)
        first = evaluate(start, None)
        found = minimize_in_trust_region(problem, first)
        # With more damping, or with less.
        for bound in (gains.high, gains.low):
            if found.last.values.min() > -GOAL_TOLERANCE:
                break
            other = minimize_in_trust_region(problem, evaluate((start + bound) / 2, None))
            found = max(found, other, key=lambda one: float(one.last.values.min()))
        return problem, first, found

    def _proved(
        self, optimum: ConstrainedOptimum, problem: ConstrainedProblem
    ) -> tuple[Result, RoundedGains] | None:
        """Round to the digits that ship, the cheapest first, and prove one that meets the goals."""
        last, shares = optimum.last, []
        for one in self.gains.roundings(last.x):
            missed = problem.penalty(last.values + optimum.jacobian @ (one.x - last.x))
            if problem.penalty(self.gains.spared(one.x)) == 0:
                rank = missed > 0, problem.cost(one.x) + missed, *one.x.tolist()
                shares.append((rank, one))
        shares.sort(key=lambda pair: pair[0])
        for _, one in shares[:MOST_ROUNDINGS]:
            designed = replace(self.given, design=self.gains.shipping(one, last.x))
            # After a failed proof, other gains cost less than other functions.
            limits = replace(search_limits(designed.spec), decay_rate=None)
            result = certify_design(designed.loaded, designed, limits=limits)
            if meets_goals(result):
                return result, one
        return None

    def _unreachable(self, last: Evaluation, *, in_floats: bool) -> DesignError:
        """Name the missed goal, and the nearest gains."""
        worst = self.constraints[int(np.argmin(last.values))]
        value, goal = float(last.values.min()), self.wanted.get(worst.key)
        number = worst.number(value)
        place = ("goals", next(iter(self.wanted), "") if goal is None else worst.key)
        if in_floats:
            return DesignError(
                f"the goals are reached in floating point, near {self.gains.said(last.x)}, but "
                "roundings take what would prove it",
                remedy="relax a goal a little, or raise design.significant_digits (at most 7)",
                at=place,
            )
        asked = "at all" if goal is None else f"of {goal.text}"
        # A rate that is not positive is no decay.
        is_none = value <= NOTHING or number <= 0
        result = "reach none" if is_none else f"reach {number:.4g} {unit(worst.unit)}"
        return DesignError(
            f"no gains within the bounds were found that one quadratic function for all modes "
            f"proves with a {worst.title} {asked}: the nearest, {self.gains.said(last.x)}, "
            f"{result}",
            remedy="relax the goal, widen the bounds, narrow the ranges, or shorten the delay; or "
            "give the gains, and let certify-switching try other functions",
            at=place,
        )
