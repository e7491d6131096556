"""Search for a function for each step of a round."""

import pytest

from nrs_design.certificates.certificate import Verdict
from nrs_design.search import periodic_quadratic
from nrs_design.search.certify import certify
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from nrs_design.search.periodic_quadratic import search_periodic_quadratic
from tests.proof.graphs import shape_of
from tests.proof.systems import (
    bouncing_in_steps,
    bouncing_in_turns,
    dayawansa_martin,
    doubled_in_turns,
)
from tests.search.support import found, outcome, thesis_robot


def test_the_rate_of_one_state_is_nearly_the_best():
    """2 (3/4)^4 = 0.6328 in five steps: 0.91256 a step."""
    evidence = found(search_periodic_quadratic, doubled_in_turns(5))
    assert shape_of(evidence) == "periodic-quadratic"
    best = (2 * 0.75**4) ** (1 / 5)
    assert best < evidence.rate < best + 0.005


def test_what_grows_is_not_found():
    evidence, words = outcome(search_periodic_quadratic, doubled_in_turns(3))
    assert evidence is None
    assert "no solution" in words


@pytest.mark.parametrize("damping", [0, 1])
def test_the_rate_is_raised(damping):
    system = bouncing_in_turns(damping, rounded=True)
    rates = [
        found(search_periodic_quadratic, system, optimize_rate=wanted).rate
        for wanted in (True, False)
    ]
    assert rates[0] < rates[1] < 1


def test_where_it_applies():
    assert applicable_methods(bouncing_in_turns()) == {Method.PERIODIC_QUADRATIC, Method.PERIOD}
    for system in (bouncing_in_steps(), dayawansa_martin(5)):
        assert Method.PERIODIC_QUADRATIC not in applicable_methods(system)
    assert outcome(search_periodic_quadratic, bouncing_in_steps())[0] is None


def test_too_many_conditions_leave_roundings_out(monkeypatch):
    system = bouncing_in_turns(rounded=True)
    assert found(search_periodic_quadratic, system).covers_rounding
    monkeypatch.setattr(periodic_quadratic, "MOST_ROUNDED", 9)
    exact = found(search_periodic_quadratic, system)
    assert not exact.covers_rounding


def test_roundings_that_leave_no_room_are_left_out():
    sampling = "{period: 2 ms, outer_period: 4 ms, delay: 0}"
    system = thesis_robot(("41.5", "44.2"), ("2.15", "1.04"), "0.01", sampling=sampling)
    assert certify(system).evidence.covers_rounding


def test_numbers_beyond_floating_point():
    assert certify(doubled_in_turns(4, 10**400)).verdict is Verdict.INCONCLUSIVE
