"""Packing of symmetric matrices, and the margin that the solver maximizes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.search.sdp import (
    MOST_STEPS,
    STEPS,
    Blocks,
    begin,
    pack,
    program_cost,
    symmetric_basis,
    unpack,
)
from nrs_design.work import Allowance

M = np.array([[3.0, 1.0, 0.0], [1.0, 2.0, -1.0], [0.0, -1.0, 4.0]])
COST = program_cost(1, 1, [(3, 1)])


@given(st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_packing_keeps_inner_products_and_can_be_undone(n, seed):
    rng = np.random.default_rng(seed)
    X, Y = (M + M.T for M in rng.standard_normal((2, n, n)))
    assert pack(X) @ pack(Y) == pytest.approx(np.trace(X @ Y))
    assert unpack(pack(X), n) == pytest.approx(X)
    assert np.tensordot(pack(X), symmetric_basis(n), axes=1) == pytest.approx(X)


def test_the_largest_margin_of_a_matrix_is_its_smallest_eigenvalue():
    x = largest_margin(Allowance())
    assert x[-1] == pytest.approx(np.linalg.eigvalsh(M).min(), abs=1e-6)


def largest_margin(allowance):
    program = Blocks()
    program.add(M, {0: -np.eye(3)})
    return program.maximize(1, begin(allowance, COST, "a program")).x


def test_the_steps_that_were_made_are_charged_not_those_that_were_predicted():
    allowance = Allowance(COST.work)
    largest_margin(allowance)
    steps = STEPS + (allowance.charged - COST.work) / COST.per_step
    assert steps == pytest.approx(round(steps))
    assert 0 < steps < STEPS
    again = Allowance()
    largest_margin(again)
    assert again.charged == allowance.charged


@pytest.mark.parametrize(("more", "most"), [(0, STEPS), (10, STEPS + 10), (1e6, MOST_STEPS)])
def test_a_solver_makes_no_more_steps_than_fit(more, most):
    allowance = Allowance(COST.work + (more + 0.5) * COST.per_step)
    assert begin(allowance, COST, "a program").most_steps == most


def test_a_solver_that_is_stopped_by_its_steps_returns_what_it_has(monkeypatch):
    monkeypatch.setattr("nrs_design.search.sdp.STEPS", 1)
    x = largest_margin(Allowance(COST.work))
    assert np.isfinite(x).all()
    assert x[-1] != pytest.approx(np.linalg.eigvalsh(M).min(), abs=1e-6)
