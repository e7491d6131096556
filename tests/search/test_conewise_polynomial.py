"""Search for polynomials for contact and free motion: known answers for the robot of the thesis.

The rates were found by an independent program, and proved in exact arithmetic there.
"""

from itertools import pairwise

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.search.certify import certify
from nrs_design.search.graphs import search_conewise_polynomial
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from nrs_design.search.polynomial import conewise_cost, family_cost
from tests.proof.graphs import shape_of
from tests.proof.systems import bouncing, bouncing_in_steps, dayawansa_martin
from tests.search.support import found, thesis_robot

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


def test_predictions_grow_with_degree_and_exceed_those_without_flight():
    costs = [conewise_cost(STIFF, d)[0] for d in range(2, 6)]
    assert all(a.work < b.work and a.memory < b.memory for a, b in pairwise(costs))
    assert costs[0].work > family_cost(STIFF, 2)[0].work
