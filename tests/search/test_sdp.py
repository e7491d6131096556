"""Packing of symmetric matrices, and the margin that the solver maximizes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.search.sdp import maximize_margin, pack, symmetric_basis, unpack


@given(st.integers(1, 6), st.integers(0, 2**32 - 1))
def test_packing_keeps_inner_products_and_can_be_undone(n, seed):
    rng = np.random.default_rng(seed)
    X, Y = (M + M.T for M in rng.standard_normal((2, n, n)))
    assert pack(X) @ pack(Y) == pytest.approx(np.trace(X @ Y))
    assert unpack(pack(X), n) == pytest.approx(X)
    assert np.tensordot(pack(X), symmetric_basis(n), axes=1) == pytest.approx(X)


def test_the_largest_margin_of_a_matrix_is_its_smallest_eigenvalue():
    M = np.array([[3.0, 1.0, 0.0], [1.0, 2.0, -1.0], [0.0, -1.0, 4.0]])
    x = maximize_margin(pack(np.eye(3))[:, None], pack(M), [3])
    assert x[-1] == pytest.approx(np.linalg.eigvalsh(M).min(), abs=1e-6)


def test_equations_come_first():
    # x1 = 2 and t <= x1.
    x = maximize_margin(np.array([[1.0, 0.0], [-1.0, 1.0]]), np.array([2.0, 0.0]), [1], 1)
    assert x == pytest.approx([2.0, 2.0], abs=1e-6)
