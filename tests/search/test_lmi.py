"""The search against an independent formulation, and its lazy choice of modes."""

import cvxpy as cp
import numpy as np
import pytest
from nrs_design.search.lmi import decreases, find_common_quadratic, margins

from nrs_design.proof.mode import Time
from nrs_design.search import lmi
from nrs_design.work import Allowance, NotAffordableError
from tests.support import thinned


def exists_by_cvxpy(matrices):
    """Margin t of the usual form, written as a person would write it."""
    n = matrices.shape[1]
    Q, t = cp.Variable((n, n), symmetric=True), cp.Variable()
    constraints = [Q >> 0, np.eye(n) - Q >> 0]
    constraints += [A.T @ Q + Q @ A + t * np.eye(n) << 0 for A in matrices]
    problem = cp.Problem(cp.Maximize(t), constraints)
    problem.solve(solver=cp.CLARABEL)
    return float(t.value)


def drawn(seed):
    generator = np.random.default_rng(seed)
    n, m = generator.integers(2, 7), generator.integers(2, 6)
    shift = generator.uniform(0.5, 2.5) * np.sqrt(n)
    return generator.standard_normal((m, n, n)) - shift * np.eye(n)


@pytest.mark.parametrize("seed", thinned(range(30), 12))
def test_existence_agrees_with_cvxpy(seed):
    matrices = drawn(seed)
    margin = exists_by_cvxpy(matrices)
    found = find_common_quadratic(matrices, Time.CONTINUOUS, 0.0)
    if margin > 1e-4:
        assert found is not None
        assert margins(matrices, found, Time.CONTINUOUS, 0.0).min() > 0
    if margin < 1e-8:
        assert found is None


def test_both_answers_occur():
    """The comparison above says something only if its families are of both sorts."""
    answers = {
        find_common_quadratic(drawn(seed), Time.CONTINUOUS, 0.0) is None for seed in range(30)
    }
    assert answers == {True, False}


@pytest.mark.parametrize("time", list(Time))
def test_few_modes_at_a_time_find_the_same(time):
    generator = np.random.default_rng(7)
    noise = generator.uniform(-0.2, 0.2, (60, 3, 3))
    matrices = noise - np.eye(3) if time is Time.CONTINUOUS else noise
    rate = 0.0 if time is Time.CONTINUOUS else 1.0
    Q = find_common_quadratic(matrices, time, rate)
    assert Q is not None
    assert margins(matrices, Q, time, rate).min() > 0
    matrices[41] = np.eye(3)
    assert find_common_quadratic(matrices, time, rate) is None


@pytest.mark.parametrize(("time", "rate"), [(Time.CONTINUOUS, 0.3), (Time.DISCRETE, 0.8)])
def test_decrease_is_the_definition(time, rate):
    generator = np.random.default_rng(1)
    A = generator.standard_normal((2, 3, 3))
    Q = np.cov(generator.standard_normal((3, 9)))
    for found, a in zip(decreases(A, Q, time, rate), A, strict=True):
        if time is Time.CONTINUOUS:
            expected = -(a.T @ Q + Q @ a + 2 * rate * Q)
        else:
            expected = rate**2 * Q - a.T @ Q @ a
        np.testing.assert_allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("answer", [np.full((2, 2), np.nan), np.diag([np.inf, 1.0])])
def test_useless_answers_end_the_search(monkeypatch, answer):
    monkeypatch.setattr(lmi, "solve_by_interior_point", lambda *arguments: answer)
    with np.errstate(all="ignore"):
        assert find_common_quadratic(-np.eye(2)[None], Time.CONTINUOUS, 0.0) is None


def test_what_does_not_fit_is_not_begun(monkeypatch):
    monkeypatch.setattr(lmi, "maximize", lambda *_: pytest.fail("begun"))
    matrices = -np.broadcast_to(np.eye(64), (2, 64, 64))
    for allowance, words in (
        (Allowance(4.0), r"2080 unknowns and 3 blocks would take about .* of work, .*--budget"),
        (Allowance(memory=1e8), "GB of memory, .*--memory"),
    ):
        with pytest.raises(NotAffordableError, match=words):
            find_common_quadratic(matrices, Time.CONTINUOUS, 0.0, allowance)


def test_a_search_that_runs_out_of_work_does_not_say_that_there_is_nothing():
    """It takes more steps than these to see that there is none."""
    matrices = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -6.0], [1 / 6, -1.0]]])
    assert find_common_quadratic(matrices, Time.CONTINUOUS, 0.0) is None
    step = Allowance()
    lmi.solve_by_interior_point(matrices, Time.CONTINUOUS, 0.0, np.eye(2), step)
    with pytest.raises(NotAffordableError, match="stopped: the budget"):
        find_common_quadratic(
            matrices, Time.CONTINUOUS, 0.0, allowance=Allowance(0.6 * step.charged)
        )
