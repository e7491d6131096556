"""Search for polynomials for contact and free motion: known answers for the robot of the thesis.

The rates were found by an independent program, and proved in exact arithmetic there.
"""

from itertools import pairwise

import numpy as np
import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.proof.contact import Contact
from nrs_design.proof.mode import Mode
from nrs_design.search import conewise_polynomial
from nrs_design.search.certify import certify
from nrs_design.search.conewise_polynomial import (
    ConewisePolynomialProgram,
    conewise_cost,
    search_conewise_polynomial,
)
from nrs_design.search.family import Family
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from nrs_design.search.polynomial import polynomial_cost
from nrs_design.work import Allowance, NotAffordableError
from tests.proof.graphs import shape_of
from tests.proof.systems import bouncing, bouncing_in_steps, dayawansa_martin, matrix
from tests.search.support import found, outcome, thesis_robot

BOTH = ("2.15", "1.04")
STIFF = thesis_robot(("43", "62"), BOTH, "0.01")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("k", "Mt", "degree", "rate"),
    [(("43", "62"), "0.01", 4, 0.84), (("25", "90.432"), "0", 6, 0.81)],
)
def test_rates_while_contact_is_lost(k, Mt, degree, rate):
    """Where no quadratic function is found; neither is one of a lower degree."""
    system = thesis_robot(k, BOTH, Mt)
    evidence = found(search_conewise_polynomial, system, degree=degree // 2)
    assert shape_of(evidence) == "conewise-polynomial"
    assert float(evidence.rate) > 0.98 * rate
    if degree > 4:
        lower = found(search_conewise_polynomial, system, degree=2, optimize_rate=False)
        assert lower is None


@pytest.mark.slow
def test_it_is_tried_before_contact_is_taken_for_granted():
    result = certify(STIFF)
    assert result.verdict is Verdict.PROVED
    assert result.method == "conewise polynomial of degree 4"
    assert "contact lost and made again" in result.statements[0].claim(STIFF)


def test_where_it_applies():
    for system in (bouncing_in_steps(), bouncing(1), dayawansa_martin(6)):
        assert Method.CONEWISE_POLYNOMIAL not in applicable_methods(system)
    assert Method.CONEWISE_POLYNOMIAL in applicable_methods(bouncing())


def test_free_motion_that_does_not_slow_down_is_not_found():
    system, free = bouncing(), Mode("free", matrix([[0, 0], [1, 0]]))
    sliding = type(system)(
        system.name, system.time, system.states, system.modes, (), contact=Contact((free,))
    )
    evidence, why = outcome(search_conewise_polynomial, sliding, degree=2)
    assert evidence is None
    assert why


@pytest.mark.parametrize("spoil", [lambda Q: -Q, lambda Q: Q * np.nan, lambda Q: np.eye(len(Q))])
def test_solutions_that_lie_give_no_false_evidence(monkeypatch, spoil):
    system = bouncing()
    program = ConewisePolynomialProgram.of(Family.of(system), 2)
    touching, flying = program.solve(0.0, Allowance())
    lie = type(touching)(spoil(touching.Q), touching.vanishing), flying
    monkeypatch.setattr(ConewisePolynomialProgram, "solve", lambda *_: lie)
    try:
        evidence = found(search_conewise_polynomial, system, degree=2)
    except (np.linalg.LinAlgError, ValueError, OverflowError):
        return
    assert evidence is None or evidence.find_fault(system) is None


def test_predictions_grow_with_degree_and_exceed_those_without_flight():
    costs = [conewise_cost(STIFF, d)[0] for d in range(2, 6)]
    assert all(a.work < b.work and a.memory < b.memory for a, b in pairwise(costs))
    assert costs[0].work > polynomial_cost(4, 4, 2)[0].work


def test_a_program_that_does_not_fit_is_not_built(monkeypatch):
    program = ConewisePolynomialProgram.of(Family.of(bouncing()), 2)
    monkeypatch.setattr(conewise_polynomial, "symmetric_basis", lambda n: pytest.fail("built"))
    with pytest.raises(NotAffordableError, match=r"3 monomials .*--budget"):
        program.solve(0.0, Allowance(1e-4))
