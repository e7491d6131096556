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
from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import (
    Result,
    assemble_spec,
    run_certification,
)
from nrs_design.pipeline.design import Designed, placed
from nrs_design.pipeline.free_gains import (
    Array,
    FreeGains,
    Written,
    gain_branches,
    has_free_gains,
    in_order,
)
from nrs_design.pipeline.proof_constraints import (
    NOTHING,
    ROOM,
    ROOM_OF_BOUNDS,
    AbstractProofConstraint,
    DesignEvaluator,
    ForceConstraint,
    RateConstraint,
)
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import rounded_up

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.trust_region import ConstrainedOptimum, ConstrainedProblem, Evaluation
    from nrs_design.spec.spec_document import SpecDocument

# Goals that gains are steered by.
STEERING = (RateConstraint.key, ForceConstraint.key)
# A rate that only has to be positive is at least so much, 1/s.
LEAST_RATE = 1e-2
# Roundings that are proved at most.
MOST_ROUNDINGS = 4
# A goal that is missed by no more than this share may be met by rounding.
NEAR = 5e-3
# What costs less does not bind.
LEAST_PRICE = 1e-4


@dataclass(frozen=True, slots=True)
class SteeredGoal:
    """A goal of the certificate that gains were chosen by."""

    key: str  # In the spec
    wanted: Fraction  # In SI units
    # What one more in SI units costs, in first order; None where the goal does not bind.
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


def steering_goals(designed: Designed, analysis: DesignAnalysis) -> tuple[str, ...]:
    """Return the goals that gains can be steered by; none where no gain is free.

    Parameters
    ----------
    designed, analysis
        The spec, and what its design achieves.
    """
    goals = designed.spec.goals
    given = [] if goals is None else [key for key, _ in goals.given()]
    return tuple(key for key in STEERING if key in given and has_free_gains(analysis))


def run_certified_optimum(
    designed: Designed,
    analysis: DesignAnalysis,
    progress: Progress = silent,
    name: str | None = None,
) -> CertifiedOptimum:
    """Choose virtual mass and damping of all controllers at once, with their proof.

    Where a mass may be zero, the best without masses and the best with them are compared: without,
    a force acts at once, else a sample later.

    Parameters
    ----------
    designed, analysis
        The spec, and what its free optimum achieves. At least one goal steers.
    progress : callable
        Told what is done.
    name : str, optional
        What the spec with these gains is called; by default as it is.

    Raises
    ------
    DesignError
        If no gains within the bounds are proved to meet the goals; it names the nearest.
    AssemblyError
        If the modes make no switched system.
    """
    with placed(designed.loaded):
        check_steerable(designed)
        found, missed = [], []
        for gains in gain_branches(designed, analysis):
            try:
                found.append(_Search(gains).run(progress, name))
            except DesignError as error:
                missed.append(error)
        if not found:
            raise missed[0]
        return min(found, key=lambda item: item.cost)


def check_steerable(designed: Designed) -> None:
    """Refuse what no choice of gains, or no form for all modes, could prove.

    Raises
    ------
    DesignError
        If the goal for the delay is beyond the declared one, or one form is no proof.
    """
    from nrs_design.search.rate_slope import may_have_slope

    goals, sampling = designed.spec.goals, designed.spec.sampling
    delay = None if goals is None else goals.delay
    if delay is not None and sampling is not None and sampling.oldest < delay.exact:
        raise DesignError(
            f"the goal delay, {delay.text}, is beyond what the spec declares: force samples are "
            f"at most {rounded_up(sampling.oldest, 's')} old",
            remedy="declare a longer sampling.delay, or relax the goal",
            at=("goals", "delay"),
        )
    if not may_have_slope(assemble_spec(designed.loaded, designed, designed.spec.coordinates)):
        raise DesignError(
            "gains are chosen with their proof only where one quadratic function may be one: not "
            "with two periods, rules that lead through unstable modes, or one state",
            remedy="leave decay_rate and peak_torque out of the goals, and certify what is "
            "optimized without them",
            at=("goals",) if goals is not None else (),
        )


class _Search:
    """The search for the cheapest gains whose proof meets the goals."""

    def __init__(self, gains: FreeGains) -> None:
        goals = gains.designed.spec.goals
        assert goals is not None, "as one steers"
        self.gains = gains
        rate, force = goals.decay_rate, goals.peak_torque
        given = zip(STEERING, (rate, force), strict=True)
        self.wanted = {key: value for key, value in given if value is not None}
        wanted = LEAST_RATE if rate is None else max(rate.si * (1 + ROOM), LEAST_RATE)
        constraints: list[AbstractProofConstraint] = [
            RateConstraint(wanted, wanted if rate is None else rate.si)
        ]
        if force is not None:
            constraints.append(ForceConstraint(force.si * (1 - ROOM_OF_BOUNDS)))
        self.constraints = tuple(constraints)

    def run(self, progress: Progress, name: str | None) -> CertifiedOptimum:
        """Search, round and prove."""
        from nrs_design.design.trust_region import ConstrainedProblem, minimize_in_trust_region

        gains = self.gains
        progress("free optimum")
        free = gains.optimum()
        evaluate = DesignEvaluator.of(gains, self.constraints, progress).evaluate
        problem = ConstrainedProblem(gains.cost, evaluate, gains.low, gains.high, gains.spared)
        first = evaluate(free, None)
        found = minimize_in_trust_region(problem, first)
        # What is not reached from one start may be from another: with more damping, or with less.
        for bound in (gains.high, gains.low):
            if found.last.values.min() > -NEAR:
                break
            other = minimize_in_trust_region(problem, evaluate((free + bound) / 2, None))
            found = max(found, other, key=lambda one: float(one.last.values.min()))
        progress("proof")
        if missed := bool(found.last.values.min() <= -NEAR):
            result, written, x = self._otherwise(free, found.last, name)
        else:
            result, written, x = self._proved(found, problem, name)
        # At the optimum of the cost alone, nothing binds.
        prices = np.zeros(len(self.constraints)) if missed else found.shadow_prices
        return CertifiedOptimum(
            result,
            written,
            gains.cost(x),
            gains.cost(free),
            self.constraints[0].number(float(first.values[0])),
            tuple(self._goals(prices)),
            found.evaluations,
        )

    def _goals(self, prices: Array) -> Iterator[SteeredGoal]:
        """Yield the goals that steered, with what they cost."""
        for constraint, price in zip(self.constraints, prices, strict=True):
            if (wanted := self.wanted.get(constraint.key)) is not None:
                own = float(price) / wanted.si if price > LEAST_PRICE else None
                yield SteeredGoal(constraint.key, wanted.exact, own)

    def _proved(
        self, found: ConstrainedOptimum, problem: ConstrainedProblem, name: str | None
    ) -> tuple[Result, Written, Array]:
        """Round to the digits that ship, the cheapest first, and prove one that meets the goals."""
        last, near = found.last, []
        for x, written in self.gains.roundings(last.x):
            missed = problem.penalty(last.values + found.jacobian @ (x - last.x))
            wrong = problem.penalty(self.gains.spared(x)) > 0
            near.append(((wrong, missed > 0, problem.cost(x) + missed), x, written))
        for x, written in in_order(near)[:MOST_ROUNDINGS]:
            if (result := self._certified(written, name)) is not None:
                return result, written, x
        digits = self.gains.designed.spec.design.significant_digits
        raise DesignError(
            f"no gains of {digits} significant digits near the best ones were proved",
            remedy="raise design.significant_digits (at most 7), or relax a goal",
            at=("goals", next(iter(self.wanted))),
        )

    def _certified(self, written: Written, name: str | None) -> Result | None:
        """Certify the spec with these gains; None if a goal that steers is not met."""
        from nrs_design.certificates.goals import certified_goals

        result = run_certification(self.gains.respecified(written, partial(_named, name)))
        goals = certified_goals(result.loaded.spec, result.certificate)
        return result if all(goal.met for goal in goals if goal.key in STEERING) else None

    def _otherwise(
        self, free: Array, last: Evaluation, name: str | None
    ) -> tuple[Result, Written, Array]:
        """Return the optimum of the cost alone if other functions prove its goals."""
        near = [((float(np.abs(x - free).sum()),), x, w) for x, w in self.gains.roundings(free)]
        x, written = in_order(near)[0]
        if (result := self._certified(written, name)) is None:
            raise self._unreachable(last)
        return result, written, x

    def _unreachable(self, last: Evaluation) -> DesignError:
        """Say which goal gains miss, and how near they come."""
        worst = self.constraints[int(np.argmin(last.values))]
        value = float(last.values.min())
        reached, wanted = worst.number(value), self.wanted.get(worst.key)
        asked = "at all" if wanted is None else f"of {wanted.text}"
        # A rate that is not positive is no decay.
        none = value <= NOTHING or reached <= 0
        reach = "reach none" if none else f"reach {reached:.4g} {unit(worst.unit)}"
        return DesignError(
            f"no gains within the bounds were found that one quadratic function for all modes "
            f"proves with a {worst.title} {asked}: the nearest, {self.gains.said(last.x)}, {reach}",
            remedy="relax the goal, widen the bounds, narrow the ranges, or shorten the delay; or "
            "give the gains, and let certify-switching try other functions",
            at=("goals", worst.key if wanted is not None else next(iter(self.wanted))),
        )


def _named(name: str | None, document: SpecDocument) -> None:
    if name is not None:
        document.put(document.root, "name", name)
