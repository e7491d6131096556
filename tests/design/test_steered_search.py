"""Optima that are known: the constraint is looked at rarely, and its price is the multiplier."""

import numpy as np
import pytest

from nrs_design.design.steered_search import MOST_LOOKS, Look, SteeredProblem, steer

LOW, HIGH = np.full(2, -4.0), np.full(2, 4.0)


def problem_of(cost, values, quick=None):
    """Look by central differences, and count looks."""

    def look(x, expected=None):
        def slopes():
            h = 1e-6
            moved = [(values(x + h * e) - values(x - h * e)) / (2 * h) for e in np.eye(len(x))]
            return np.array(moved).T

        return Look(x, values(x), slopes)

    more = {} if quick is None else {"quick": quick}
    return SteeredProblem(cost, look, LOW, HIGH, **more)


def steered(problem, start):
    return steer(problem, problem.look(np.array(start), None))


def squares(x):
    return float((x[0] - 1) ** 2 + (x[1] - 2) ** 2)


def test_a_constraint_that_does_not_bind_costs_nothing():
    found = steered(problem_of(squares, lambda x: np.array([10 - x.sum()])), (0.0, 0.0))
    assert found.last.x == pytest.approx([1, 2], abs=1e-4)
    assert found.prices == pytest.approx([0], abs=1e-6)


def test_a_linear_constraint_and_its_multiplier():
    """The nearest point of ``x + y <= 2`` to (1, 2) is (1/2, 3/2); the multiplier is one."""
    found = steered(problem_of(squares, lambda x: np.array([2 - x.sum()])), (0.0, 0.0))
    assert found.last.x == pytest.approx([0.5, 1.5], abs=1e-3)
    assert found.prices == pytest.approx([1.0], rel=0.02)


def test_a_curved_constraint():
    """On the unit disk, (1, 2) over its length, at the distance sqrt(5) - 1."""
    found = steered(problem_of(squares, lambda x: np.array([1 - x @ x])), (0.1, -0.2))
    assert found.last.x == pytest.approx(np.array([1, 2]) / 5**0.5, abs=3e-3)
    assert found.cost == pytest.approx((5**0.5 - 1) ** 2, rel=2e-3)
    assert found.looks <= MOST_LOOKS


def test_a_cost_with_a_kink():
    found = steered(
        problem_of(lambda x: abs(x[0] - 1) + abs(x[1] - 2), lambda x: np.array([x[0] - 1.5])),
        (0.0, 0.0),
    )
    assert found.last.x == pytest.approx([1.5, 2], abs=1e-3)


def test_quick_constraints_hold_as_well():
    quick = problem_of(
        squares, lambda x: np.array([2 - x.sum()]), lambda x: np.array([0.25 - x[0]])
    )
    found = steered(quick, (0.0, 0.0))
    assert found.last.x == pytest.approx([0.25, 1.75], abs=1e-3)


def test_what_cannot_be_met_is_missed_by_little():
    found = steered(problem_of(squares, lambda x: np.array([x[0] - 6])), (0.0, 0.0))
    assert found.last.x[0] == pytest.approx(4.0)
    assert found.last.values[0] == pytest.approx(-2.0)


def test_slopes_that_lie_end_the_search_and_not_the_program():
    wrong = problem_of(squares, lambda x: np.array([np.sin(40 * x[0])]))
    found = steered(wrong, (0.0, 0.0))
    assert found.looks <= MOST_LOOKS
    assert np.isfinite(found.cost)
