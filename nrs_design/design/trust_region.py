"""The least cost under constraints that take long to evaluate.

Between evaluations a constraint is taken as linear, within a region that grows where that was right
and shrinks where it was wrong (sequential programming with a trust region and an exact penalty;
Nocedal and Wright 2006, chapter 18).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

REGION, SMALLEST_REGION = 0.25, 1e-3  # How far a coordinate moves at first, and at least
PENALTY = 10.0  # Added cost of a constraint violated by one
# A step is kept if it brings this share of what was predicted; from the other on, the region grows.
ACCEPTED, GOOD = 0.1, 0.6
# Least improvement.
CHEAPER = 2e-5
MOST_EVALUATIONS = 24
WRONG = 0.012  # Slopes that were wrong by more than this share are found again


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Values and slopes at a point."""

    x: Array  # Shape (n,)
    values: Array  # Shape (k,). Of the constraints; those that are not negative are met.
    jacobian: Callable[[], Array]  # Gives shape (k, n); takes long


@dataclass(frozen=True, eq=False)
class ConstrainedProblem:
    """Cost and constraints."""

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
    evaluations: int


def minimize_in_trust_region(problem: ConstrainedProblem, start: Evaluation) -> ConstrainedOptimum:
    """Minimize the cost from a start; constraints that cannot be met are missed by little.

    Slopes are found again where they were wrong.
    """
    current, slopes, count, region = start, start.jacobian(), 1, REGION
    while count < MOST_EVALUATIONS and region >= SMALLEST_REGION:
        trial = _cheapest(problem, current, slopes, region)
        predicted_values = current.values + slopes @ (trial - current.x)
        merit = _merit(problem, current.x, current.values)
        predicted = merit - _merit(problem, trial, predicted_values)
        if predicted < CHEAPER:
            break
        found, count = problem.evaluate(trial, predicted_values), count + 1
        gained = merit - _merit(problem, trial, found.values)
        if gained < ACCEPTED * predicted:
            region = min(region, float(np.abs(trial - current.x).max())) / 2
            continue
        if (
            np.abs(found.values - predicted_values)
            > WRONG * np.abs(predicted_values - current.values)
        ).any():
            slopes = found.jacobian()
        current, region = found, 2 * region if gained >= GOOD * predicted else region
    return ConstrainedOptimum(current, slopes, problem.cost(current.x), count)


def _merit(problem: ConstrainedProblem, x: Array, values: Array) -> float:
    return problem.cost(x) + problem.penalty(values) + problem.penalty(problem.quick(x))


def _cheapest(
    problem: ConstrainedProblem, current: Evaluation, slopes: Array, region: float
) -> Array:
    """Minimize the cost where a linear model holds as well as it can, within the region."""
    low = np.maximum(problem.low, current.x - region)
    high = np.minimum(problem.high, current.x + region)

    def met(x: Array) -> Array:
        return np.concatenate([current.values + slopes @ (x - current.x), problem.quick(x)])

    return cheapest(problem.cost, met, low, high, current.x)


def cheapest(
    cost: Callable[[Array], float],
    met: Callable[[Array], Array],
    low: Array,
    high: Array,
    start: Array,
) -> Array:
    """Minimize a quick cost where quick constraints are met, or missed by little, from a start."""
    from scipy.optimize import NonlinearConstraint, minimize

    n, k = len(start), len(met(start))

    def merit(z: Array) -> float:
        return cost(np.clip(z[:n], low, high)) + PENALTY * float(z[n:].sum())

    # Behind the point there is by how much each constraint may be missed.
    found = minimize(
        merit,
        np.concatenate([start, np.maximum(-met(start), 0.0)]),
        method="SLSQP",
        bounds=[*zip(low, high, strict=True), *[(0.0, None)] * k],
        constraints=NonlinearConstraint(lambda z: met(z[:n]) + z[n:], 0.0, np.inf) if k else (),
        options={"ftol": 1e-9, "maxiter": 200},
    )
    return np.asarray(np.clip(found.x[:n], low, high), dtype=float)
