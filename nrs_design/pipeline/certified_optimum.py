"""The cheapest gains whose proof meets the goals of a certificate: all controllers jointly.

The cost is that of `nrs_design.design.impedance_optimum`, summed over the controllers. What a
proof shows is known at a design, with its slope (`nrs_design.search.rate_slope`); between two
designs it is taken as linear in the logarithms of the gains, within a region that shrinks where
that was wrong. Gains are rounded to the digits that ship, and the proof of these is searched and
checked as that of any spec.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import (
    Result,
    assemble_spec,
    run_certification,
    search_limits,
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
from nrs_design.progress import Progress, silent
from nrs_design.proof.bounds import rounded_up
from nrs_design.work import Allowance, Fuse, NotAffordableError

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.steered_search import Look, Steered, SteeredProblem
    from nrs_design.models.plant import Plant
    from nrs_design.proof.system import SwitchedSystem
    from nrs_design.spec.spec_document import SpecDocument

# Goals that gains are steered by.
STEERING = ("decay_rate",)
# Of a rate that is asked for, so much more is sought: roundings take a little.
ROOM = 5e-4
# How far a coordinate moves for a slope.
STEP = 1e-3
# Roundings that are proved at most.
MOST_ROUNDINGS = 4
# A goal with less than this share to spare binds.
NEAR = 5e-3


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
            remedy="leave goals.decay_rate out, and certify what is optimized without it",
            at=("goals", *STEERING) if goals is not None and goals.decay_rate else (),
        )


@dataclass(frozen=True)
class RateLooks:
    """Looks at the best decay rate of designs, held against one that is asked for."""

    gains: FreeGains
    wanted: float  # 1/s
    scale: float  # What one of the values of a look is, 1/s
    allowance: Allowance
    progress: Progress

    @classmethod
    def of(cls, gains: FreeGains, wanted: float, scale: float, progress: Progress) -> RateLooks:
        """Take work and memory from the spec.

        Parameters
        ----------
        gains, wanted, scale, progress
            As for the class.
        """
        limits = search_limits(gains.designed.spec)
        allowance = Allowance(limits.budget, limits.memory, Fuse.of(limits.budget))
        return cls(gains, wanted, scale, allowance, progress)

    def rate(self, value: float) -> float:
        """Return the rate in 1/s that a value of a look stands for."""
        return float(value) * self.scale + self.wanted

    def look(
        self,
        x: Array,
        expected: Array | None,
        plant: Callable[[Array], Plant | None] = lambda x: None,
    ) -> Look:
        """Find the best decay rate of a design, and let its slope be asked for.

        Parameters
        ----------
        x : ndarray
            The point; what is behind the gains is for the plant.
        expected : ndarray or None
            About what comes of it.
        plant : callable
            Gives the plant at a point, if it is not that of the spec.

        Raises
        ------
        DesignError
            If work or memory do not suffice.
        """
        from nrs_design.design.steered_search import Look
        from nrs_design.search.rate_slope import rate_slope

        gains, n = self.gains, len(self.gains.places)

        def system(x: Array) -> SwitchedSystem:
            return gains.system(x[:n], plant(x))

        guess = None if expected is None else self.rate(expected[0])
        try:
            found = rate_slope(system(x), guess, self.allowance)
        except NotAffordableError as error:
            raise DesignError(
                f"no gains were found: {error}", remedy="allow more with certification.budget"
            ) from error
        if found is None:
            return Look(x, np.array([-1.0]), lambda: np.zeros((1, len(x))))
        self.progress(f"decay rate {found.rate:.4g} 1/s at cost {gains.cost(x[:n]):.5g}")

        def slopes() -> Array:
            moved = []
            for i in range(len(x)):
                step = -STEP if i < n and x[i] + STEP > gains.high[i] else STEP
                there = system(x + step * np.eye(len(x))[i])
                moved.append(found.change(there) / step / self.scale)
            return np.array([moved])

        return Look(x, np.array([(found.rate - self.wanted) / self.scale]), slopes)


class _Search:
    """The search for the cheapest gains whose decay rate is proved."""

    def __init__(self, gains: FreeGains) -> None:
        goals = gains.designed.spec.goals
        assert goals is not None
        assert goals.decay_rate is not None, "the only goal that steers"
        self.gains, self.goal = gains, goals.decay_rate

    def run(self, progress: Progress, name: str | None) -> CertifiedOptimum:
        """Search, round and prove."""
        from nrs_design.design.steered_search import SteeredProblem, steer

        gains = self.gains
        progress("free optimum")
        free = gains.optimum()
        looks = RateLooks.of(gains, self.goal.si * (1 + ROOM), self.goal.si, progress)
        problem = SteeredProblem(gains.cost, looks.look, gains.low, gains.high, gains.spared)
        first = looks.look(free, None)
        found = steer(problem, first)
        # What is not reached from one start may be from another: with more damping, or with less.
        for bound in (gains.high, gains.low):
            if found.last.values[0] > -NEAR:
                break
            other = steer(problem, looks.look((free + bound) / 2, None))
            found = max(found, other, key=lambda one: float(one.last.values[0]))
        rate = looks.rate(found.last.values[0])
        if found.last.values[0] <= -NEAR:
            raise self._unreachable(found.last.x, rate)
        progress("proof")
        result, written, x = self._proved(found, problem, name)
        binds = rate < self.goal.si * (1 + NEAR)
        price = float(found.prices[0]) / looks.scale if binds else None
        return CertifiedOptimum(
            result,
            written,
            gains.cost(x),
            gains.cost(free),
            looks.rate(first.values[0]),
            (SteeredGoal("decay_rate", self.goal.exact, self.goal.text, rate, price),),
            found.looks,
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
            at=("goals", "decay_rate"),
        )

    def _unreachable(self, x: Array, rate: float) -> DesignError:
        """Say how near the goal gains come."""
        return DesignError(
            f"no gains within the bounds were found to be proved with a decay rate of "
            f"{self.goal.text}: the nearest, {self.gains.said(x)}, reach {rate:.4g} 1/s",
            remedy="relax the goal, widen the bounds, narrow the ranges, or shorten the delay",
            at=("goals", "decay_rate"),
        )


def _named(name: str | None, document: SpecDocument) -> None:
    if name is not None:
        document.put(document.root, "name", name)
