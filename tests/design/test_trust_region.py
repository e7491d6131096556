"""Optima that are known: the constraint is looked at rarely, and its price is the multiplier."""

import numpy as np
import pytest

from nrs_design.design.trust_region import (
    MOST_EVALUATIONS,
    ConstrainedProblem,
    Evaluation,
    minimize_in_trust_region,
)

LOW, HIGH = np.full(2, -4.0), np.full(2, 4.0)


def problem_of(cost, values, quick=None):
    """Evaluate by central differences."""

    def evaluate(x, expected=None):
        def jacobian():
            h = 1e-6
            moved = [(values(x + h * e) - values(x - h * e)) / (2 * h) for e in np.eye(len(x))]
            return np.array(moved).T

        return Evaluation(x, values(x), jacobian)

    more = {} if quick is None else {"quick": quick}
    return ConstrainedProblem(cost, evaluate, LOW, HIGH, **more)


def optimum_of(problem, start):
    return minimize_in_trust_region(problem, problem.evaluate(np.array(start), None))


def squares(x):
    return float((x[0] - 1) ** 2 + (x[1] - 2) ** 2)


def test_a_constraint_that_does_not_bind_costs_nothing():
    found = optimum_of(problem_of(squares, lambda x: np.array([10 - x.sum()])), (0.0, 0.0))
    assert found.last.x == pytest.approx([1, 2], abs=1e-4)
    assert found.shadow_prices == pytest.approx([0], abs=1e-6)


def test_a_linear_constraint_and_its_multiplier():
    """The nearest point of ``x + y <= 2`` to (1, 2) is (1/2, 3/2); the multiplier is one."""
    found = optimum_of(problem_of(squares, lambda x: np.array([2 - x.sum()])), (0.0, 0.0))
    assert found.last.x == pytest.approx([0.5, 1.5], abs=1e-3)
    assert found.shadow_prices == pytest.approx([1.0], rel=0.02)


def test_a_curved_constraint():
    """On the unit disk, (1, 2) over its length, at the distance sqrt(5) - 1."""
    found = optimum_of(problem_of(squares, lambda x: np.array([1 - x @ x])), (0.1, -0.2))
    assert found.last.x == pytest.approx(np.array([1, 2]) / 5**0.5, abs=3e-3)
    assert found.cost == pytest.approx((5**0.5 - 1) ** 2, rel=2e-3)
    assert found.evaluations <= MOST_EVALUATIONS


def test_a_cost_with_a_kink():
    found = optimum_of(
        problem_of(lambda x: abs(x[0] - 1) + abs(x[1] - 2), lambda x: np.array([x[0] - 1.5])),
        (0.0, 0.0),
    )
    assert found.last.x == pytest.approx([1.5, 2], abs=1e-3)


def test_quick_constraints_hold_as_well():
    quick = problem_of(
        squares, lambda x: np.array([2 - x.sum()]), lambda x: np.array([0.25 - x[0]])
    )
    found = optimum_of(quick, (0.0, 0.0))
    assert found.last.x == pytest.approx([0.25, 1.75], abs=1e-3)


def test_what_cannot_be_met_is_missed_by_little():
    found = optimum_of(problem_of(squares, lambda x: np.array([x[0] - 6])), (0.0, 0.0))
    assert found.last.x[0] == pytest.approx(4.0)
    assert found.last.values[0] == pytest.approx(-2.0)


def test_slopes_that_lie_end_the_search_and_not_the_program():
    wrong = problem_of(squares, lambda x: np.array([np.sin(40 * x[0])]))
    found = optimum_of(wrong, (0.0, 0.0))
    assert found.evaluations <= MOST_EVALUATIONS
    assert np.isfinite(found.cost)
