"""What a little more cost buys: the most that is proved for it, of one objective at a time.

The cost is that of `optimize`, summed over the impedance controllers. For each share that it may be
above its least, gains are searched for the largest stiffness of the contacts, or the fastest decay,
that is proved; what is reported has been rounded, and checked exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from math import exp, floor, log, log10
from typing import TYPE_CHECKING, Any

import numpy as np

from nrs_design.certificates.bounds import bound_on
from nrs_design.certificates.goals import decay_rate
from nrs_design.design.objective import Objective
from nrs_design.errors import DesignError
from nrs_design.pipeline.certification import Result, run_certification
from nrs_design.pipeline.certified_optimum import check_steerable
from nrs_design.pipeline.design import Designed, placed
from nrs_design.pipeline.free_gains import (
    Array,
    FreeGains,
    gain_branches,
    has_free_gains,
    in_order,
)
from nrs_design.pipeline.proof_constraints import LEAST_RATE, DesignEvaluator, rate_constraint
from nrs_design.pipeline.stability_map import as_stiff
from nrs_design.pipeline.written_gains import Written
from nrs_design.progress import Progress, silent
from nrs_design.proof.text import exact_text

if TYPE_CHECKING:
    from nrs_design.design.analysis import DesignAnalysis
    from nrs_design.design.trust_region import Evaluation
    from nrs_design.models.plant import Plant
    from nrs_design.spec.quantity import Quantity
    from nrs_design.spec.quantity_fields import RangedQuantity
    from nrs_design.spec.spec_document import SpecDocument

# Upper ends of stiffness are looked for up to so many times the declared ones.
WIDEST = 64.0
# A cost beyond what is allowed by this share of the least counts as one missed constraint.
BEYOND = 0.2
# Roundings take a little of a rate.
ROOM = 5e-4
# What is found is claimed with so much less, until it is proved.
BACK_OFFS = (5e-4, 2e-3, 1e-2, 5e-2)
# Roundings may cost this share more than is allowed.
NO_MORE = 2e-3
# Logarithm of the least factor between the ends of a stiffness.
LEAST_WIDTH = 1e-3
# Rates are looked for up to this one, 1/s.
FASTEST = 1e4
DIGITS = 4


@dataclass(frozen=True, slots=True)
class TradeOffPoint:
    """Gains, what they cost, and what is proved of them."""

    share: Fraction | None  # By how much the cost might be above the least; None: the free optimum
    cost: float  # Summed over the controllers
    gains: Written  # What ships of the free ones
    result: Result  # Of the spec with these gains and ranges; its certificate was checked exactly
    rate: Fraction  # Proved, 1/s

    @property
    def stiffness(self) -> dict[str, Fraction]:
        """Upper end of the stiffness of every contact, N m/rad."""
        designed = self.result.designed
        assert designed is not None, "as it has gains"
        touched = designed.plant.among(designed.design.contacts)
        return {environment.name: environment.stiffness.high for environment in touched}

    @property
    def force(self) -> Fraction | None:
        """Proved bound on the force under all disturbances of the spec, N m; None without any."""
        found = self.result.certificate
        bound = None if found is None else bound_on(found.system, found.statements, "force")
        return None if bound is None else bound.level


@dataclass(frozen=True, slots=True)
class TradeOffCurve:
    """The points of designs of one kind."""

    massless: bool  # Whether all virtual masses are zero
    least_cost: float  # Without anything to prove
    points: tuple[TradeOffPoint, ...]  # By rising cost


def run_trade_off(
    designed: Designed,
    analysis: DesignAnalysis,
    objective: Objective,
    shares: Sequence[Fraction],
    progress: Progress = silent,
) -> tuple[TradeOffCurve, ...]:
    """Find what is proved for a little more cost.

    Parameters
    ----------
    designed, analysis
        The spec, and what its free optimum achieves.
    objective : Objective
        What is to be large.
    shares : sequence of Fraction
        By which the cost may be above its least.
    progress : callable
        Told what is done.

    Returns
    -------
    tuple of TradeOffCurve
        One without virtual masses and one with them, where the spec allows both.

    Raises
    ------
    DesignError
        If no gain is free, or nothing is proved at any cost.
    """
    with placed(designed.loaded):
        if not has_free_gains(designed, analysis):
            raise DesignError(
                "no gain is free to be chosen",
                remedy="give Mt or Bt of an impedance controller bounds, {min: ..., max: ...}",
                at=("controllers",),
            )
        check_steerable(designed)
        if objective is Objective.STIFFNESS:
            _stretchable(designed)
        curves = [
            _Curve(gains, objective, progress).run(shares)
            for gains in gain_branches(designed, analysis)
        ]
    if not any(curve.points for curve in curves):
        raise DesignError(
            "nothing was proved at any of these costs",
            path=designed.loaded.path,
            remedy="allow more cost, or narrow the ranges",
        )
    return tuple(curves)


def _stretchable(designed: Designed) -> tuple[tuple[str, RangedQuantity], ...]:
    """Return the contacts whose stiffness is stretched, and what the spec says of it.

    Raises
    ------
    DesignError
        If one of them has no single stiffness.
    """
    touched = designed.plant.among(designed.design.contacts)
    given = []
    for environment in touched:
        spec = designed.spec.environments.get(environment.name)
        stiffness = getattr(spec, "stiffness", None)
        if environment.parts or environment.preloaded or stiffness is None:
            raise DesignError(
                f"the environment {environment.name} has no stiffness of its own to stretch",
                remedy="use contacts of one spring, touched one at a time and without a preload",
                at=("environments", environment.name),
            )
        given.append((environment.name, stiffness))
    return tuple(given)


class _Curve:
    """The points of one kind of designs: behind the gains, the objective is a coordinate.

    That is the logarithm of the factor on the upper ends of stiffness, or the rate over `scale`.
    """

    def __init__(self, gains: FreeGains, objective: Objective, progress: Progress) -> None:
        self.gains, self.objective, self.progress = gains, objective, progress
        plant, contacts = gains.designed.plant, gains.designed.design.contacts
        touched = plant.among(contacts)
        self.contacts = tuple((e.name, e.stiffness.low, e.stiffness.high) for e in touched)
        # The nominal stiffness, which the cost is of, stays within.
        self.softest = max(e.stiffness.nominal / e.stiffness.high for e in touched)
        goals = gains.designed.spec.goals
        goal = None if goals is None else goals.decay_rate
        self.wanted = Fraction(0) if goal is None else goal.exact
        self.least_rate = max(float(self.wanted) * (1 + ROOM), LEAST_RATE)
        self.scale = max(self.least_rate, 1.0)

    @property
    def stretches(self) -> bool:
        """Whether the stiffness is the objective."""
        return self.objective is Objective.STIFFNESS

    def run(self, shares: Sequence[Fraction]) -> TradeOffCurve:
        """Return the free optimum, as far as something is proved of it, and all points."""
        free = self.gains.optimum()
        least = self.gains.cost(free)
        x = np.append(free, max(0.0, log(self.softest) + LEAST_WIDTH) if self.stretches else 0.0)
        found = [self._proved(x, None, least, least)]
        for share in sorted(shares):
            budget = least * (1 + float(share))
            x = self._largest(x, budget, least)
            found.append(self._proved(x, share, budget, least))
        points = tuple(one for one in found if one is not None)
        return TradeOffCurve(self.gains.massless, least, points)

    def _largest(self, start: Array, budget: float, least: float, *, fixed: bool = False) -> Array:
        """Return the point with the largest objective within a cost, or with the same gains."""
        from nrs_design.design.trust_region import ConstrainedProblem, minimize_in_trust_region

        gains, n = self.gains, len(self.gains.coordinates)

        def quick(x: Array) -> Array:
            over = (budget - gains.cost(x[:n])) / (BEYOND * least)
            return np.asarray([min(over, 1.0), *gains.spared(x[:n])])

        least_y, most_y = -FASTEST / self.scale, FASTEST / self.scale
        if self.stretches:
            # A range keeps its two ends, as modes are one for each.
            least_y, most_y = log(self.softest) + LEAST_WIDTH, log(WIDEST)
        low, high = (start[:n], start[:n]) if fixed else (gains.low, gains.high)
        # What a search may take is for one point.
        constraint = rate_constraint(self.least_rate, self.scale)
        evaluator = DesignEvaluator.of(gains, (constraint,), self.progress)
        evaluate = partial(self._evaluate, evaluator)
        problem = ConstrainedProblem(
            lambda x: -float(x[n]),
            evaluate,
            np.append(low, least_y),
            np.append(high, most_y),
            (lambda x: np.zeros(0)) if fixed else quick,
        )
        return minimize_in_trust_region(problem, evaluate(start, None)).last.x

    def _evaluate(self, evaluator: DesignEvaluator, x: Array, expected: Array | None) -> Evaluation:
        """Find the rate of a design: at its stiffness, or beside the rate that is asked for."""
        from nrs_design.design.trust_region import Evaluation

        if self.stretches:
            return evaluator.evaluate(x, expected, self._plant)
        found = evaluator.evaluate(x[:-1], None if expected is None else expected + x[-1])
        return Evaluation(x, found.values - x[-1], lambda: np.hstack([found.jacobian(), [[-1.0]]]))

    def _plant(self, x: Array) -> Plant:
        """Return the plant with the upper ends of stiffness at a point."""
        factor = Fraction(exp(max(float(x[-1]), log(self.softest) + LEAST_WIDTH)))
        return as_stiff(self.gains.designed.plant, self.contacts, factor)

    def _proved(
        self, x: Array, share: Fraction | None, budget: float, least: float
    ) -> TradeOffPoint | None:
        """Round the gains, and prove the most that is possible with them."""
        gains, n = self.gains, len(self.gains.coordinates)
        near = [
            ((max(gains.cost(own) / budget - 1, NO_MORE), _apart(own, x[:n])), own, written)
            for own, written in gains.roundings(x[:n])
        ]
        own, written = in_order(near)[0]
        rounded = self._largest(np.append(own, x[n:]), budget, least, fixed=True)
        for back_off in BACK_OFFS:
            factor = Fraction(exp(float(rounded[-1]))) * (1 - Fraction(back_off))
            change = partial(_stretched, gains.designed, factor)
            result = run_certification(
                gains.respecified(written, change if self.stretches else _unchanged)
            )
            rate = decay_rate(result.certificate)
            if rate is not None and rate >= self.wanted:
                self.progress(f"proved at cost {gains.cost(own):.5g}")
                return TradeOffPoint(share, gains.cost(own), written, result, rate)
            if not self.stretches:
                break
        return None


def _apart(one: Array, other: Array) -> float:
    return float(np.abs(one - other).sum())


def _unchanged(document: SpecDocument) -> None:
    """Leave the document as it is."""


def _stretched(designed: Designed, factor: Fraction, document: SpecDocument) -> None:
    """Write the upper ends of stiffness, rounded down."""
    for name, stiffness in _stretchable(designed):
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
