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
from nrs_design.pipeline.design_looks import (
    ROOM,
    ROOM_OF_BOUNDS,
    AbstractJudge,
    DesignLooks,
    ForceJudge,
    RateJudge,
)
from nrs_design.pipeline.free_gains import (
    Array,
    FreeGains,
    Written,
    gain_branches,
    has_free_gains,
    in_order,
)
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import rounded_up
from nrs_design.spec import Quantity

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.steered_search import Look, Steered, SteeredProblem
    from nrs_design.spec.spec_document import SpecDocument

# Goals that gains are steered by.
STEERING = ("decay_rate", "peak_torque")
GOAL_UNITS = {"decay_rate": "1/s", "peak_torque": "N*m"}
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
    text: str  # As the spec writes it
    found: float  # In floating point, before gains are rounded
    # What one more in SI units costs, in first order; None where the goal does not bind.
    price: float | None


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
        self.wanted = {key: value for key, value in goals.given() if key in STEERING}
        rate, force = goals.decay_rate, goals.peak_torque
        wanted = LEAST_RATE if rate is None else max(rate.si * (1 + ROOM), LEAST_RATE)
        judges: list[AbstractJudge] = [
            RateJudge("decay_rate", wanted, wanted if rate is None else rate.si)
        ]
        if force is not None:
            judges.append(ForceJudge("peak_torque", force.si * (1 - ROOM_OF_BOUNDS)))
        self.judges = tuple(judges)

    def run(self, progress: Progress, name: str | None) -> CertifiedOptimum:
        """Search, round and prove."""
        from nrs_design.design.steered_search import SteeredProblem, steer

        gains = self.gains
        progress("free optimum")
        free = gains.optimum()
        looks = DesignLooks.of(gains, self.judges, progress)
        problem = SteeredProblem(gains.cost, looks.look, gains.low, gains.high, gains.spared)
        first = looks.look(free, None)
        found = steer(problem, first)
        # What is not reached from one start may be from another: with more damping, or with less.
        for bound in (gains.high, gains.low):
            if found.last.values.min() > -NEAR:
                break
            other = steer(problem, looks.look((free + bound) / 2, None))
            found = max(found, other, key=lambda one: float(one.last.values.min()))
        progress("proof")
        if found.last.values.min() <= -NEAR:
            result, written, x = self._otherwise(free, found.last, name)
        else:
            result, written, x = self._proved(found, problem, name)
        return CertifiedOptimum(
            result,
            written,
            gains.cost(x),
            gains.cost(free),
            self.judges[0].number(float(first.values[0])),
            tuple(self._goals(found)),
            found.looks,
        )

    def _goals(self, found: Steered) -> Iterator[SteeredGoal]:
        """Yield the goals that steered, with what they cost."""
        for judge, value, price in zip(self.judges, found.last.values, found.prices, strict=True):
            if (wanted := self.wanted.get(judge.key)) is None:
                continue
            assert isinstance(wanted, Quantity)
            yield SteeredGoal(
                judge.key,
                wanted.exact,
                wanted.text,
                judge.number(float(value)),
                float(price) / wanted.si if price > LEAST_PRICE else None,
            )

    def _proved(
        self, found: Steered, problem: SteeredProblem, name: str | None
    ) -> tuple[Result, Written, Array]:
        """Round to the digits that ship, the cheapest first, and prove one that meets the goals."""
        from nrs_design.certificates.goals import certified_goals

        last, near = found.last, []
        for x, written in self.gains.roundings(last.x):
            missed = problem.penalty(last.values + found.slopes @ (x - last.x))
            wrong = problem.penalty(self.gains.spared(x)) > 0
            near.append(((wrong, missed > 0, problem.cost(x) + missed), x, written))
        for x, written in in_order(near)[:MOST_ROUNDINGS]:
            result = run_certification(self.gains.respecified(written, partial(_named, name)))
            goals = certified_goals(result.loaded.spec, result.certificate)
            if all(goal.met for goal in goals if goal.key in STEERING):
                return result, written, x
        digits = self.gains.designed.spec.design.significant_digits
        raise DesignError(
            f"no gains of {digits} significant digits near the best ones were proved",
            remedy="raise design.significant_digits (at most 7), or relax a goal",
            at=("goals", next(iter(self.wanted))),
        )

    def _otherwise(
        self, free: Array, last: Look, name: str | None
    ) -> tuple[Result, Written, Array]:
        """Return the optimum of the cost alone if other functions prove its goals."""
        from nrs_design.certificates.goals import certified_goals

        near = [((float(np.abs(x - free).sum()),), x, w) for x, w in self.gains.roundings(free)]
        x, written = in_order(near)[0]
        result = run_certification(self.gains.respecified(written, partial(_named, name)))
        goals = certified_goals(result.loaded.spec, result.certificate)
        if not all(goal.met for goal in goals if goal.key in STEERING):
            raise self._unreachable(last)
        return result, written, x

    def _unreachable(self, last: Look) -> DesignError:
        """Say which goal gains miss, and how near they come."""
        worst = self.judges[int(np.argmin(last.values))]
        reached = worst.number(float(last.values.min()))
        wanted = self.wanted.get(worst.key)
        asked = "at all" if wanted is None else f"of {getattr(wanted, 'text', wanted)}"
        what = "decay rate" if worst.key == "decay_rate" else "bound on the force"
        reach = f"reach {reached:.4g} {unit(GOAL_UNITS[worst.key])}"
        if worst.key == "decay_rate" and reached <= 0:
            reach = "reach none"
        return DesignError(
            f"no gains within the bounds were found that one quadratic function for all modes "
            f"proves with a {what} {asked}: the nearest, {self.gains.said(last.x)}, {reach}",
            remedy="relax the goal, widen the bounds, narrow the ranges, or shorten the delay; or "
            "give the gains, and let certify-switching try other functions",
            at=("goals", worst.key if wanted is not None else next(iter(self.wanted))),
        )


def _named(name: str | None, document: SpecDocument) -> None:
    if name is not None:
        document.put(document.root, "name", name)
