"""Optima that are known: the constraint is looked at rarely."""

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


def kinked(x):
    return abs(x[0] - 1) + abs(x[1] - 2)


# The nearest point of ``x + y <= 2`` to (1, 2) is (1/2, 3/2).
@pytest.mark.parametrize(
    ("cost", "values", "quick", "x", "within"),
    [
        (squares, lambda x: 10 - x.sum(), None, (1, 2), 1e-4),
        (squares, lambda x: 2 - x.sum(), None, (0.5, 1.5), 1e-3),
        (squares, lambda x: 2 - x.sum(), lambda x: 0.25 - x[0], (0.25, 1.75), 1e-3),
        (kinked, lambda x: x[0] - 1.5, None, (1.5, 2), 1e-3),
        # What cannot be met is missed by little.
        (squares, lambda x: x[0] - 6, None, (4, None), 1e-6),
    ],
    ids=["idle", "linear", "quick", "kink", "out of reach"],
)
def test_optima_by_hand(cost, values, quick, x, within):
    more = None if quick is None else lambda x: np.array([quick(x)])
    found = optimum_of(problem_of(cost, lambda x: np.array([values(x)]), more), (0.0, 0.0))
    for own, wanted in zip(found.last.x, x, strict=True):
        assert wanted is None or own == pytest.approx(wanted, abs=within)


def test_a_curved_constraint():
    """On the unit disk, (1, 2) over its length, at the distance sqrt(5) - 1."""
    found = optimum_of(problem_of(squares, lambda x: np.array([1 - x @ x])), (0.1, -0.2))
    assert found.last.x == pytest.approx(np.array([1, 2]) / 5**0.5, abs=3e-3)
    assert found.cost == pytest.approx((5**0.5 - 1) ** 2, rel=2e-3)
    assert found.evaluations <= MOST_EVALUATIONS


def test_slopes_that_lie_end_the_search_and_not_the_program():
    wrong = problem_of(squares, lambda x: np.array([np.sin(40 * x[0])]))
    found = optimum_of(wrong, (0.0, 0.0))
    assert found.evaluations <= MOST_EVALUATIONS
    assert np.isfinite(found.cost)
