"""What a little more cost buys: the most that is proved for it, of one objective at a time.

The cost is that of `optimize`, summed over the impedance controllers. For each share that it may be
above its least, gains are searched for the largest stiffness of the contacts, the fastest decay,
the least bound on the force, or the least noise that is proved; and for each age of the force, the
cheapest gains. What is reported has been rounded, and checked exactly.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import exp, floor, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.certificates.goals import certified_goals, decay_rate
from nrs_design.design.objective import Objective
from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import run_certification
from nrs_design.pipeline.certified_optimum import (
    STEERING,
    cheapest_gains,
    check_steerable,
    meets_goals,
)
from nrs_design.pipeline.design import Designed, placed
from nrs_design.pipeline.free_gains import Array, FreeGains, gain_branches, has_free_gains, in_order
from nrs_design.pipeline.goal_ranges import wanted_age, with_delay
from nrs_design.pipeline.proof_constraints import DesignEvaluator
from nrs_design.pipeline.trade_axis import TradeAxis, check_objective, stretchable, trade_axis
from nrs_design.pipeline.trade_point import TradeOffPoint
from nrs_design.progress import Progress, silent
from nrs_design.proof.text import exact_text
from nrs_design.spec.sampling import LONGEST_DELAY

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.trust_region import Evaluation
    from nrs_design.spec.quantity import Quantity
    from nrs_design.spec.spec_document import SpecDocument

# A cost beyond what is allowed by this share of the least counts as one missed constraint.
BEYOND = 0.2
# What is found is claimed with so much less, until it is proved.
BACK_OFFS = (5e-4, 2e-3, 1e-2, 5e-2)
# Roundings may cost this share more than is allowed.
NO_MORE = 2e-3
DIGITS = 4


@dataclass(frozen=True, slots=True)
class TradeOffCurve:
    """The points of designs of one kind."""

    objective: Objective
    massless: bool  # Whether all virtual masses are zero
    least_cost: float  # Without anything to prove
    points: tuple[TradeOffPoint, ...]  # By rising cost


def run_trade_off(
    designed: Designed,
    analysis: DesignAnalysis,
    objectives: Sequence[Objective],
    shares: Sequence[Fraction],
    progress: Progress = silent,
) -> tuple[TradeOffCurve, ...]:
    """Find what is proved for a little more cost.

    Parameters
    ----------
    designed, analysis
        The spec, and what its free optimum achieves; its goals that steer are asked for, too.
    objectives : sequence of Objective
        What is to be large or small, each for itself.
    shares : sequence of Fraction
        By which the cost may be above its least.
    progress : callable
        Told what is done.

    Returns
    -------
    tuple of TradeOffCurve
        For each objective one without virtual masses and one with them, where the spec allows both.

    Raises
    ------
    DesignError
        If no gain is free, nothing has a cost, or nothing is proved at any.
    """
    with placed(designed.loaded):
        if not (has_free_gains(designed, analysis) and analysis.impedance):
            raise DesignError(
                "no gain is free to be chosen, or none of them has a cost",
                remedy="give Mt or Bt of an impedance controller bounds, {min: ..., max: ...}",
                at=("controllers",),
            )
        for objective in objectives:
            check_objective(designed, objective)
        if (age := wanted_age(designed)) is not None:
            designed, analysis = with_delay(designed, analysis, age)
        check_steerable(designed)
        curves = []
        for objective in objectives:
            for gains in gain_branches(designed, analysis):
                if objective is Objective.DELAY:
                    curves.append(_over_ages(gains, shares, progress))
                else:
                    curves.append(_Curve(gains, trade_axis(gains, objective), progress).run(shares))
    if not any(curve.points for curve in curves):
        raise DesignError(
            "nothing was proved at any of these costs",
            path=designed.loaded.path,
            remedy="allow more cost, or narrow the ranges",
        )
    return tuple(curves)


def _over_ages(gains: FreeGains, shares: Sequence[Fraction], progress: Progress) -> TradeOffCurve:
    """Return the cheapest gains for each age of the force, from the declared one on."""
    designed = gains.designed
    sampling = designed.spec.sampling
    assert sampling is not None, "as has been checked"
    least, found = gains.cost(gains.optimum()), []
    for age in range(sampling.delay[1], LONGEST_DELAY + 1):
        progress(f"force samples up to {age} periods old")
        try:
            later = FreeGains(*with_delay(designed, gains.analysis, age), gains.massless)
            best = cheapest_gains(later, progress)
        except DesignError:
            break  # With an older force there is less still.
        share = Fraction(best.cost / least - 1)
        if share > max(shares) + Fraction(NO_MORE):
            break
        rate = decay_rate(best.result.certificate)
        assert rate is not None, "as it is proved"
        bounds = best.at_bounds
        found.append(TradeOffPoint(share, best.cost, best.gains, best.result, rate, bounds))
    return TradeOffCurve(Objective.DELAY, gains.massless, least, tuple(found))


class _Curve:
    """The points of one kind of designs: behind the gains, the objective is a coordinate."""

    def __init__(self, gains: FreeGains, axis: TradeAxis, progress: Progress) -> None:
        self.gains, self.axis, self.progress = gains, axis, progress
        self.n = len(gains.coordinates)

    def run(self, shares: Sequence[Fraction]) -> TradeOffCurve:
        """Return the free optimum, as far as something is proved of it, and all points."""
        free = self.gains.optimum()
        least = self.gains.cost(free)
        x = np.append(free, self._start(free))
        found = [self._proved(x, None, least, least)]
        for share in sorted(shares):
            budget = least * (1 + float(share))
            x = self._largest(x, budget, least)
            found.append(self._proved(x, share, budget, least))
        points = tuple(one for one in found if one is not None)
        return TradeOffCurve(self.axis.objective, self.gains.massless, least, points)

    def _start(self, free: Array) -> float:
        """Return where the objective begins."""
        if own := self.axis.quick(free, 0.0):
            return min(own)
        if not any(self.axis.taken):
            return self.axis.start(np.zeros(len(self.axis.constraints)))
        return self.axis.start(self._evaluator().evaluate(free, None).values)

    def _evaluator(self) -> DesignEvaluator:
        # What a search may take is for one point.
        return DesignEvaluator.of(self.gains, self.axis.constraints, self.progress)

    def _largest(self, start: Array, budget: float, least: float, *, fixed: bool = False) -> Array:
        """Return the point with the largest objective within a cost, or with the same gains."""
        from nrs_design.design.trust_region import ConstrainedProblem, minimize_in_trust_region

        gains, axis, n = self.gains, self.axis, self.n

        def quick(x: Array) -> Array:
            over = (budget - gains.cost(x[:n])) / (BEYOND * least)
            own = axis.quick(x[:n], float(x[n]))
            return np.asarray([min(over, 1.0), *gains.spared(x[:n]), *own])

        low, high = (start[:n], start[:n]) if fixed else (gains.low, gains.high)
        evaluate = partial(self._evaluate, self._evaluator())
        problem = ConstrainedProblem(
            lambda x: -float(x[n]),
            evaluate,
            np.append(low, axis.low),
            np.append(high, axis.high),
            (lambda x: np.zeros(0)) if fixed else quick,
        )
        return minimize_in_trust_region(problem, evaluate(start, None)).last.x

    def _evaluate(self, evaluator: DesignEvaluator, x: Array, expected: Array | None) -> Evaluation:
        """Find what a design shows: of the plant there, or beside what is asked for."""
        from nrs_design.design.trust_region import Evaluation

        if self.axis.stretches:
            return evaluator.evaluate(x, expected, lambda x: self.axis.plant(float(x[-1])))
        taken = np.array(self.axis.taken)
        own = x[-1] * taken
        found = evaluator.evaluate(x[:-1], None if expected is None else expected + own)
        return Evaluation(
            x, found.values - own, lambda: np.hstack([found.jacobian(), -taken[:, None]])
        )

    def _proved(
        self, x: Array, share: Fraction | None, budget: float, least: float
    ) -> TradeOffPoint | None:
        """Round the gains, and prove the most that is possible with them."""
        gains, n = self.gains, self.n
        near = [
            ((max(gains.cost(own) / budget - 1, NO_MORE), _apart(own, x[:n])), own, written)
            for own, written in gains.roundings(x[:n])
        ]
        own, written = in_order(near)[0]
        changes = [_unchanged]
        if self.axis.stretches:
            rounded = self._largest(np.append(own, x[n:]), budget, least, fixed=True)
            factor = Fraction(exp(float(rounded[-1])))
            changes = [
                partial(_stretched, gains.designed, factor * (1 - Fraction(back_off)))
                for back_off in BACK_OFFS
            ]
        for change in changes:
            result = run_certification(gains.respecified(written, change))
            rate = decay_rate(result.certificate)
            if rate is not None and rate > 0 and meets_goals(result):
                self.progress(f"proved at cost {gains.cost(own):.5g}")
                bounds = gains.at_bounds(x[:n])
                return TradeOffPoint(share, gains.cost(own), written, result, rate, bounds)
        return None


def unasked_goals(points: Sequence[TradeOffPoint]) -> Iterator[str]:
    """Yield the goals of the proof that no gains are chosen by, and that a point misses.

    Parameters
    ----------
    points : sequence of TradeOffPoint
        All that are known.
    """
    missed = dict.fromkeys(
        goal.key
        for point in points
        for goal in certified_goals(point.result.loaded.spec, point.result.certificate)
        if goal.key not in STEERING and not goal.met
    )
    yield from missed


def _apart(one: Array, other: Array) -> float:
    return float(np.abs(one - other).sum())


def _unchanged(document: SpecDocument) -> None:
    """Leave the document as it is."""


def _stretched(designed: Designed, factor: Fraction, document: SpecDocument) -> None:
    """Write the upper ends of stiffness, rounded down."""
    for name, stiffness in stretchable(designed):
        low, high = stiffness.range
        top = max(_digits_below(high.value * factor), _in_unit(stiffness.nominal, high))
        said: dict[str, Any] = {
            "nominal": stiffness.nominal.text,
            "range": [low.text, f"{exact_text(top)} {high.unit}"],
        }
        node = document.root["environments"][name]
        document.put(node, "stiffness", said if stiffness.varies else said | {"varies": "false"})
        document.drop(node, "range_id")


def _in_unit(quantity: Quantity, other: Quantity) -> Fraction:
    """Return the number of a quantity in the unit of another."""
    if quantity.unit == other.unit:
        return quantity.value
    return quantity.exact * other.value / other.exact


def _digits_below(value: Fraction) -> Fraction:
    """Round down to a few significant digits."""
    step = Fraction(10) ** (floor(log10(value)) + 1 - DIGITS)
    return floor(value / step) * step
