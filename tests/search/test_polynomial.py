"""Search for common polynomials, and rounding so that vanishing forms vanish exactly."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.evidence.graph import MAX_DEGREE, MAX_MONOMIALS
from nrs_design.proof.lift import monomials, vanishes
from nrs_design.proof.mode import Time
from nrs_design.search import polynomial
from nrs_design.search.family import Family, floats_in_silence
from nrs_design.search.lifted import lift_family, products
from nrs_design.search.polynomial import (
    PolynomialSolution,
    find_common_polynomial,
    highest_degree,
    polynomial_cost,
    search_polynomial,
)
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.systems import ando_shih, dayawansa_martin, family
from tests.search.support import found


def lifted(system, degree):
    family_ = Family.of(system)
    return family_, lift_family(system, family_.exponents, degree)


@pytest.mark.parametrize("system", [dayawansa_martin(6), ando_shih("0.7")])
def test_a_solution_becomes_evidence(system):
    assert found(search_polynomial, system, degree=2).find_fault(system) is None


def test_fast_ones_are_proposed_first_and_the_sure_one_at_last():
    proposed = list(search_polynomial(Family.of(dayawansa_martin(6)), degree=2))
    words = [candidate.words for candidate in proposed]
    half = len(words) // 2
    assert words == ["found with a decay rate near the largest"] * half + ["found"] * half
    for part in (proposed[:half], proposed[half:]):
        rates = [candidate.evidence.rate for candidate in part]
        assert rates == sorted(rates, reverse=True)
    assert proposed[0].evidence.rate > proposed[half].evidence.rate


def test_no_solution_where_there_is_none():
    _, lift = lifted(dayawansa_martin(12), 2)
    assert find_common_polynomial(lift, dayawansa_martin(12).time, 0.0) is None


@pytest.mark.parametrize(("n", "degree"), [(2, 2), (2, 5), (3, 2), (4, 2)])
def test_vanishing_forms_span_the_whole_null_space(n, degree):
    system = family([[-(i == j) for j in range(n)] for i in range(n)])
    lift = lift_family(system, np.zeros(n, dtype=np.int64), degree)
    K = len(monomials(n, degree))
    dimension = K * (K + 1) // 2 - len(monomials(n, 2 * degree))
    assert len(lift.vanishing) == dimension
    assert np.linalg.matrix_rank(lift.vanishing.reshape(dimension, -1)) == dimension


@given(st.integers(1, 3), st.integers(1, 4), st.randoms(use_true_random=False))
def test_corrected_forms_vanish_whatever_was_rounded(n, degree, random):
    K = len(monomials(n, degree))
    N = [[0] * K for _ in range(K)]
    for i in range(K):
        for j in range(i, K):
            N[i][j] = N[j][i] = random.randint(-(10**20), 10**20)
    corrected = polynomial.make_vanish(N, products(n, degree))
    assert vanishes(corrected, n, degree)
    assert all(corrected[i][j] == corrected[j][i] for i in range(K) for j in range(K))


@pytest.mark.parametrize(
    "spoil",
    [
        lambda c: replace(c, Q=-c.Q),
        lambda c: replace(c, Q=np.eye(len(c.Q))),
        lambda c: replace(c, Q=c.Q * np.nan),
        lambda c: replace(c, Q=c.Q * 1e300),
        lambda c: replace(c, Q=np.triu(c.Q)),
        lambda c: replace(c, vanishing=c.vanishing * np.nan),
        lambda c: replace(c, vanishing=c.vanishing + 1e9 * np.eye(len(c.Q))),
    ],
)
def test_solutions_that_lie_give_no_false_evidence(monkeypatch, spoil):
    unstable, stable = dayawansa_martin(12), dayawansa_martin(6)
    _, lift_stable = lifted(stable, 2)
    with floats_in_silence():
        solution = spoil(find_common_polynomial(lift_stable, stable.time, 0.0))
    assert isinstance(solution, PolynomialSolution)
    monkeypatch.setattr(polynomial, "find_common_polynomial", lambda *_: solution)
    for system in (unstable, stable):
        try:
            evidence = found(search_polynomial, system, degree=2)
        except (np.linalg.LinAlgError, ValueError, OverflowError):
            continue
        assert evidence is None or (system is stable and evidence.find_fault(system) is None)


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


def test_a_program_that_does_not_fit_is_not_built(monkeypatch):
    _, lift = lifted(dayawansa_martin(6), 2)
    monkeypatch.setattr(polynomial, "symmetric_basis", lambda n: pytest.fail("built"))
    with pytest.raises(NotAffordableError, match=r"3 monomials .*--budget"):
        find_common_polynomial(lift, Time.CONTINUOUS, 0.0, Allowance(1e-4))
