"""The least cost under constraints that take long to evaluate.

Between evaluations a constraint is taken as linear, within a region that grows where that was right
and shrinks where it was wrong (sequential programming with a trust region and an exact penalty;
Nocedal and Wright 2006, chapter 18).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# How far a coordinate moves at first, and at least.
REGION, SMALLEST_REGION = 0.25, 1e-3
# A constraint that is missed by one adds so much to the cost.
PENALTY = 10.0
# A step is kept if it brings this share of what was predicted; from the other on, the region grows.
KEPT, GOOD = 0.1, 0.6
# What is less is no improvement.
CHEAPER = 2e-5
MOST_EVALUATIONS = 24
# Linear models beside that where the search stands, and by how much one may be below what is known.
MOST_CUTS, CONTRADICTS = 6, 1e-3
# Slopes that were wrong by more than this share are found again.
WRONG = 0.012
# How far a constraint is moved for its shadow price; one met by more than the slack has none.
MOVED, SLACK = 0.01, 0.05


@dataclass(frozen=True, eq=False)
class Evaluation:
    """What is known at a point."""

    x: Array  # Shape (n,)
    values: Array  # Shape (k,). Of the constraints; those that are not negative are met.
    jacobian: Callable[[], Array]  # Gives shape (k, n); takes long


@dataclass(frozen=True, eq=False)
class ConstrainedProblem:
    """What is to be cheap, and what is to be met."""

    cost: Callable[[Array], float]  # Quick
    evaluate: Callable[[Array, Array], Evaluation]  # At a point, given what is expected; takes long
    low: Array
    high: Array
    # Constraints that are quick: not negative where they are met.
    quick: Callable[[Array], Array] = field(default=lambda x: np.zeros(0))

    def penalty(self, values: Array) -> float:
        """Return what missed constraints add to the cost."""
        return PENALTY * float(np.maximum(-values, 0.0).sum())


@dataclass(frozen=True, eq=False)
class ConstrainedOptimum:
    """Where a search ended."""

    last: Evaluation
    jacobian: Array  # Shape (k, n), there
    cost: float
    # Shape (k,). What the cost rises by if a constraint is one harder to meet.
    shadow_prices: Array
    evaluations: int


def minimize_in_trust_region(problem: ConstrainedProblem, start: Evaluation) -> ConstrainedOptimum:
    """Minimize the cost from a start; constraints that cannot be met are missed by little.

    A constraint that is a minimum of several has ridges, where its gradient says little. So it is
    taken as the least of its linear models at the last evaluations (Kelley 1960), of those that do
    not contradict what is known where the search stands.
    """
    here = _Cut.of(start)
    cuts, count, region = [here], 1, REGION
    while count < MOST_EVALUATIONS and region >= SMALLEST_REGION:
        there = _cheapest(problem, here.x, cuts, region)
        reached = _model(cuts, there)
        merit = _merit(problem, here.x, here.values)
        predicted = merit - _merit(problem, there, reached)
        if predicted < CHEAPER:
            break
        found, count = problem.evaluate(there, reached), count + 1
        gained = merit - _merit(problem, there, found.values)
        cut = _updated(here, found) or _Cut.of(found)
        if gained >= KEPT * predicted:
            here = cut
            region = 2 * region if gained >= GOOD * predicted else region
        else:
            region = min(region, float(np.abs(there - here.x).max())) / 2
        others = [one for one in (*cuts, cut) if one is not here and one.allows(here)]
        cuts = [here, *others[-MOST_CUTS:]]
    shadow_prices = np.array([*_shadow_prices(problem, here)])
    last = Evaluation(here.x, here.values, lambda: here.jacobian)
    return ConstrainedOptimum(last, here.jacobian, problem.cost(here.x), shadow_prices, count)


@dataclass(frozen=True, eq=False)
class _Cut:
    """The linear model of all constraints at a point."""

    x: Array
    values: Array
    jacobian: Array

    @classmethod
    def of(cls, found: Evaluation) -> Self:
        return cls(found.x, found.values, found.jacobian())

    def at(self, x: Array) -> Array:
        return np.asarray(self.values + self.jacobian @ (x - self.x))

    def allows(self, known: _Cut) -> bool:
        """Tell whether it does not say less than what is known at another point."""
        return bool((self.at(known.x) >= known.values - CONTRADICTS).all())


def _model(cuts: Sequence[_Cut], x: Array) -> Array:
    return np.asarray(np.min([cut.at(x) for cut in cuts], axis=0))


def _updated(here: _Cut, found: Evaluation) -> _Cut | None:
    """Return a model that tells the last step (Broyden 1965); None if the old one was too wrong."""
    step = found.x - here.x
    expected = here.jacobian @ step
    wrong = found.values - here.values - expected
    if (np.abs(wrong) > WRONG * np.abs(expected)).any():
        return None
    return _Cut(found.x, found.values, here.jacobian + np.outer(wrong, step) / (step @ step))


def _merit(problem: ConstrainedProblem, x: Array, values: Array) -> float:
    return problem.cost(x) + problem.penalty(values) + problem.penalty(problem.quick(x))


def _cheapest(
    problem: ConstrainedProblem, here: Array, cuts: Sequence[_Cut], region: float
) -> Array:
    """Minimize the cost where linear models hold as well as they can, within the region."""
    from scipy.optimize import NonlinearConstraint, minimize

    n, k = len(here), len(cuts[0].values)
    low = np.maximum(problem.low, here - region)
    high = np.minimum(problem.high, here + region)

    def met(z: Array) -> Array:
        """Return what must not be negative."""
        linear = [cut.at(z[:n]) + z[n : n + k] for cut in cuts]
        return np.concatenate([*linear, problem.quick(z[:n]) + z[n + k]])

    # Behind the point there is by how much each constraint may be missed.
    quick = float(np.maximum(-problem.quick(here), 0.0).max(initial=0.0))
    start = np.concatenate([here, np.maximum(-_model(cuts, here), 0.0), [quick]])

    def merit(z: Array) -> float:
        return problem.cost(np.clip(z[:n], low, high)) + PENALTY * float(z[n:].sum())

    found = minimize(
        merit,
        start,
        method="SLSQP",
        bounds=[*zip(low, high, strict=True), *[(0.0, None)] * (k + 1)],
        constraints=NonlinearConstraint(met, 0.0, np.inf),
        options={"ftol": 1e-9, "maxiter": 200},
    )
    return np.asarray(np.clip(found.x[:n], low, high), dtype=float)


def _shadow_prices(problem: ConstrainedProblem, here: _Cut) -> Iterator[float]:
    """Yield what each constraint costs near a point, in first order; nothing for one far from it.

    A search ends a little inside of what binds.
    """

    def cost(values: Array) -> float:
        cut = _Cut(here.x, values, here.jacobian)
        return problem.cost(_cheapest(problem, here.x, [cut], REGION))

    for i, value in enumerate(here.values):
        if value > SLACK:
            yield 0.0
            continue
        met, harder = here.values.copy(), here.values.copy()
        met[i], harder[i] = 0.0, -MOVED
        yield max(cost(harder) - cost(met), 0.0) / MOVED
