"""Packing of symmetric matrices, and the margin that the solver maximizes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof import exact
from nrs_design.search import sdp
from nrs_design.search.work import Allowance
from tests.proof.truth import determinant, is_definite
from tests.support import ends_soon
from tests.tables import by_rows

M = np.array([[3.0, 1.0, 0.0], [1.0, 2.0, -1.0], [0.0, -1.0, 4.0]])


@given(st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_packing_keeps_inner_products_and_can_be_undone(n, seed):
    rng = np.random.default_rng(seed)
    X, Y = (M + M.T for M in rng.standard_normal((2, n, n)))
    assert sdp.pack(X) @ sdp.pack(Y) == pytest.approx(np.trace(X @ Y))
    assert sdp.unpack(sdp.pack(X), n) == pytest.approx(X)
    assert np.tensordot(sdp.pack(X), sdp.symmetric_basis(n), axes=1) == pytest.approx(X)


def test_the_largest_margin_of_a_matrix_is_its_smallest_eigenvalue():
    x = largest_margin(Allowance())
    assert x[-1] == pytest.approx(np.linalg.eigvalsh(M).min(), abs=1e-6)


def program():
    found = sdp.SemidefiniteProgram(1)
    found.add(M, [(0, sdp.packed_columns(-np.eye(3)[None]))])
    return found


def largest_margin(allowance):
    return program().maximize(allowance).x


def test_the_steps_that_were_made_are_charged_not_those_that_were_predicted():
    cost = program().cost()
    allowance = Allowance(cost.work)
    largest_margin(allowance)
    steps = sdp.STEPS + (allowance.charged - cost.work) / cost.per_step
    assert steps == pytest.approx(round(steps))
    assert 0 < steps < sdp.STEPS
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
    alone, shared = sdp.SemidefiniteProgram(7), sdp.SemidefiniteProgram(7)
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
    assert sdp.unpack(
        (sdp.packed_congruence(L, R) + sdp.packed_congruence(R, L)) @ sdp.pack(Q), 4
    ) == pytest.approx(both)


def test_a_dual_is_that_of_its_block():
    """The margin is the least eigenvalue, and grows by what its vector sees of the block."""
    (dual,) = program().maximize(Allowance()).duals
    _, vectors = np.linalg.eigh(M)
    assert dual == pytest.approx(np.outer(vectors[:, 0], vectors[:, 0]), abs=1e-5)


@st.composite
def factors(draw):
    """Draw an integer matrix with any number of rows and columns."""
    rows, columns = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    return [[draw(st.integers(-20, 20)) for _ in range(columns)] for _ in range(rows)]


@st.composite
def symmetric(draw):
    n = draw(st.integers(1, 4))
    upper = {(i, j): draw(st.integers(-3, 3)) for i in range(n) for j in range(i, n)}
    return [[upper[min(i, j), max(i, j)] for j in range(n)] for i in range(n)]


def identity(n):
    return [[int(i == j) for j in range(n)] for i in range(n)]


@by_rows("M", "semidefinite")
def test_matrices_that_can_be_decided_by_eye(M, semidefinite):
    assert exact.is_positive_semidefinite(M) is semidefinite


@given(factors())
def test_squares_are_semidefinite_and_definite_iff_of_full_rank(L):
    M = exact.congruence(L, identity(len(L)))
    assert exact.is_positive_semidefinite(M)
    assert exact.is_positive_definite(M) is (determinant(M) > 0)


@given(factors(), st.integers(0, 4))
def test_a_singular_square_less_anything_is_not_semidefinite(L, index):
    # A zero row and column, except for a negative corner.
    M = exact.congruence([[*row, 0] for row in L], identity(len(L)))
    M[-1][-1] = -1 - index
    assert not exact.is_positive_semidefinite(M)


@given(symmetric())
def test_agrees_with_all_principal_minors(M):
    assert exact.is_positive_semidefinite(M) is is_definite(M, strictly=False)


@given(symmetric())
def test_agrees_with_eigenvalues_away_from_the_boundary(M):
    smallest = np.linalg.eigvalsh(np.array(M, dtype=float)).min()
    if abs(smallest) > 1e-6:
        assert exact.is_positive_semidefinite(M) is bool(smallest > 0)


@given(factors())
def test_congruence_and_add_as_numpy_has_them(L):
    n = len(L)
    Q = [[(i + 2) * (j + 3) for j in range(n)] for i in range(n)]
    expected = np.array(L).T @ np.array(Q) @ np.array(L)
    assert exact.congruence(L, Q) == expected.tolist()
    assert exact.add(exact.congruence(L, Q), exact.congruence(L, Q), -3) == (-2 * expected).tolist()


@pytest.mark.parametrize("M", [[], [[1, 2], [3, 4]]])
def test_what_is_not_symmetric_is_an_error(M):
    with pytest.raises(ValueError, match="symmetric"):
        exact.is_positive_semidefinite(M)


def test_numbers_stay_small_over_the_whole_elimination():
    n = 24
    M = exact.congruence([[(i * j) % 17 - 8 for j in range(n)] for i in range(n)], identity(n))
    with ends_soon():
        assert exact.is_positive_semidefinite(M)


def test_only_what_would_take_minutes_is_too_large():
    assert not exact.is_too_large([[2**300] * 64 for _ in range(64)])
    assert not exact.is_too_large([[10**4299] * 8 for _ in range(8)])
    assert exact.is_too_large([[2**1000] * 64 for _ in range(64)])
    assert exact.is_too_large([[1] * 1000 for _ in range(1000)])
    assert not exact.is_too_large([])
