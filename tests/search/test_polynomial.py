"""What polynomials cost, and forms that vanish."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.evidence.graph import MAX_DEGREE, MAX_MONOMIALS
from nrs_design.proof.lift import monomials, vanishes
from nrs_design.search.lifted import make_vanish, products, vanishing_basis
from nrs_design.search.polynomial import conewise_cost, highest_degree, polynomial_cost
from tests.search.support import thesis_robot


@pytest.mark.parametrize(("n", "degree"), [(2, 2), (2, 5), (3, 2), (4, 2)])
def test_vanishing_forms_span_the_whole_null_space(n, degree):
    K = len(monomials(n, degree))
    basis = vanishing_basis(n, degree, np.zeros(K, dtype=np.int64))
    dimension = K * (K + 1) // 2 - len(monomials(n, 2 * degree))
    assert len(basis) == dimension
    assert np.linalg.matrix_rank(basis.reshape(dimension, -1)) == dimension


@given(st.integers(1, 3), st.integers(1, 4), st.randoms(use_true_random=False))
def test_corrected_forms_vanish_whatever_was_rounded(n, degree, random):
    K = len(monomials(n, degree))
    N = [[0] * K for _ in range(K)]
    for i in range(K):
        for j in range(i, K):
            N[i][j] = N[j][i] = random.randint(-(10**20), 10**20)
    corrected = make_vanish(N, products(n, degree))
    assert vanishes(corrected, n, degree)
    assert all(corrected[i][j] == corrected[j][i] for i in range(K) for j in range(K))


def test_highest_degrees_that_a_certificate_can_hold():
    assert [highest_degree(n) for n in (1, 2, 3, 4, 14, 15, 64, 200)] == [32, 32, 14, 7, 2, 2, 1, 1]
    for n in range(2, 20):
        d = highest_degree(n)
        assert len(monomials(n, d)) <= MAX_MONOMIALS
        assert d == MAX_DEGREE // 2 or len(monomials(n, d + 1)) > MAX_MONOMIALS


def test_predictions_grow_with_degree_and_modes():
    costs = [polynomial_cost(2, 2, d)[0] for d in range(2, 33)]
    assert all(a.work < b.work and a.memory < b.memory for a, b in pairwise(costs))
    assert costs[0].work < 0.1
    assert polynomial_cost(2, 4, 8)[0].work > polynomial_cost(2, 2, 8)[0].work


def test_predictions_exceed_those_without_flight():
    system = thesis_robot(("43", "62"), ("2.15", "1.04"), "0.01")
    costs = [conewise_cost(system, d)[0] for d in range(2, 6)]
    assert all(a.work < b.work and a.memory < b.memory for a, b in pairwise(costs))
    assert costs[0].work > polynomial_cost(4, 4, 2)[0].work
