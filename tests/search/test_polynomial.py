"""Search for common polynomials, and rounding so that vanishing forms vanish exactly."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.evidence.graph import MAX_DEGREE, MAX_MONOMIALS
from nrs_design.proof.lift import monomials, vanishes
from nrs_design.search.family import Family
from nrs_design.search.graphs import search_polynomial
from nrs_design.search.polynomial import (
    family_cost,
    highest_degree,
    make_vanish,
    products,
    vanishing_basis,
)
from tests.proof.systems import ando_shih, dayawansa_martin
from tests.search.support import found


@pytest.mark.parametrize("system", [dayawansa_martin(6), ando_shih("0.7")])
def test_a_solution_becomes_evidence(system):
    assert found(search_polynomial, system, degree=2).find_fault(system) is None


def test_fast_ones_are_proposed_first_and_the_sure_one_at_last():
    proposed = list(search_polynomial(Family.of(dayawansa_martin(6)), degree=2))
    for words in ("found with a decay rate near the largest", "found"):
        rates = [candidate.evidence.rate for candidate in proposed if candidate.words == words]
        assert rates == sorted(rates, reverse=True)
    assert proposed[0].evidence.rate > rates[0]


def test_no_solution_where_there_is_none():
    assert found(search_polynomial, dayawansa_martin(12), degree=2) is None


@pytest.mark.parametrize(("n", "degree"), [(2, 2), (2, 5), (3, 2), (4, 2)])
def test_vanishing_forms_span_the_whole_null_space(n, degree):
    K = len(monomials(n, degree))
    basis = vanishing_basis(n, degree, np.zeros(K, dtype=np.int64))
    dimension = K * (K + 1) // 2 - len(monomials(n, 2 * degree))
    assert len(basis) == dimension == np.linalg.matrix_rank(basis.reshape(dimension, -1))


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
    costs = [family_cost(dayawansa_martin(6), d)[0] for d in range(2, 33)]
    assert all(a.work < b.work and a.memory < b.memory for a, b in pairwise(costs))
    assert costs[0].work < 0.1
