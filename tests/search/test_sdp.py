"""Packing of symmetric matrices, and the margin that the solver maximizes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.search.sdp import (
    STEPS,
    SemidefiniteProgram,
    pack,
    packed_columns,
    packed_congruence,
    symmetric_basis,
    unpack,
)
from nrs_design.work import Allowance

M = np.array([[3.0, 1.0, 0.0], [1.0, 2.0, -1.0], [0.0, -1.0, 4.0]])


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


def program():
    found = SemidefiniteProgram(1)
    found.add(M, [(0, packed_columns(-np.eye(3)[None]))])
    return found


def largest_margin(allowance):
    return program().maximize(allowance).x


def test_the_steps_that_were_made_are_charged_not_those_that_were_predicted():
    cost = program().cost()
    allowance = Allowance(cost.work)
    largest_margin(allowance)
    steps = STEPS + (allowance.charged - cost.work) / cost.per_step
    assert steps == pytest.approx(round(steps))
    assert 0 < steps < STEPS
    again = Allowance()
    largest_margin(again)
    assert again.charged == allowance.charged


def test_a_solver_that_is_stopped_by_its_steps_returns_what_it_has(monkeypatch):
    monkeypatch.setattr("nrs_design.search.sdp.STEPS", 1)
    x = largest_margin(Allowance(program().cost().work))
    assert np.isfinite(x).all()
    assert x[-1] != pytest.approx(np.linalg.eigvalsh(M).min(), abs=1e-6)


def test_unknowns_of_one_block_alone_cost_less():
    """Two blocks of their own, with one unknown in common, or all in both."""
    alone, shared = SemidefiniteProgram(7), SemidefiniteProgram(7)
    for k in range(2):
        alone.add(M, [(3 * k, np.eye(6)[:, :3]), (6, np.eye(6)[:, :1])])
        shared.add(M, [(0, np.ones((6, 7)))])
    assert alone.cost().work < shared.cost().work


@given(st.integers(0, 2**32 - 1))
def test_a_congruence_is_linear_in_the_form(seed):
    rng = np.random.default_rng(seed)
    L, R, Q = rng.standard_normal((4, 3)), rng.standard_normal((4, 3)), rng.standard_normal((3, 3))
    Q = Q + Q.T
    both = L @ Q @ R.T + R @ Q @ L.T
    assert unpack(
        (packed_congruence(L, R) + packed_congruence(R, L)) @ pack(Q), 4
    ) == pytest.approx(both)


def test_a_dual_is_that_of_its_block():
    """The margin is the least eigenvalue, and grows by what its vector sees of the block."""
    (dual,) = program().maximize(Allowance()).duals
    _, vectors = np.linalg.eigh(M)
    assert dual == pytest.approx(np.outer(vectors[:, 0], vectors[:, 0]), abs=1e-5)
