"""Graphs that searches draw: what they decide, and where they apply."""

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.search import graphs
from nrs_design.search.certify import Limits, certify
from nrs_design.search.graphs import (
    search_conewise_modes,
    search_periodic_quadratic,
    search_together,
)
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from tests.proof.graphs import shape_of
from tests.proof.systems import (
    bouncing,
    bouncing_in_steps,
    bouncing_in_turns,
    dayawansa_martin,
    doubled_in_turns,
)
from tests.search.support import found, outcome, thesis_robot
from tests.search.test_pieces import A, B, timed

BOTH = ("2.15", "1.04")
slow = pytest.mark.slow


@pytest.mark.parametrize(
    ("k", "Mt", "delay"),
    [
        ("42.5", "0.01", 2),
        ("53.1", "0", 2),
        pytest.param("36.1", "0.01", 5, marks=slow),
        pytest.param("44.3", "0", 5, marks=slow),
    ],
)
def test_a_stiffness_that_moves_far_is_proved_while_contact_is_lost(k, Mt, delay):
    """Where no single function is found: the largest k that was proved in kept contact."""
    sampling = f"{{period: 2 ms, delay: {delay}}}"
    system = thesis_robot(("20", k), BOTH, Mt, sampling=sampling, contact="losable")
    assert found(search_together, system, optimize_rate=False) is None
    result = certify(system, limits=Limits(optimize_rate=False))
    assert result.verdict is Verdict.PROVED
    assert shape_of(result.evidence) == "conewise-mode-quadratic"
    forms = [form for place, form in result.evidence.nodes if place == "modes"]
    # Both ends of an enclosed number share theirs.
    assert (len(forms), len(set(forms))) == (8, 4)


@pytest.mark.parametrize(
    ("search", "system"),
    [
        (search_conewise_modes, bouncing_in_steps()),
        (search_periodic_quadratic, bouncing_in_turns(0, rounded=True)),
        (search_periodic_quadratic, bouncing_in_turns(1, rounded=True)),
    ],
)
def test_the_rate_is_raised(search, system):
    rates = [found(search, system, optimize_rate=wanted).rate for wanted in (True, False)]
    assert rates[0] < rates[1] < 1


def test_where_they_apply():
    turns, steps = {Method.PERIODIC_QUADRATIC}, {Method.CONEWISE_MODE_QUADRATIC}
    flows = {Method.CONEWISE_POLYNOMIAL}
    assert applicable_methods(bouncing_in_turns()) == turns | {Method.PERIOD}
    assert outcome(search_periodic_quadratic, bouncing_in_steps())[0] is None
    for system, methods in (
        (bouncing_in_steps(), steps),
        (bouncing(), flows),
        (bouncing(1), set()),
        (dayawansa_martin(5), set()),
    ):
        assert applicable_methods(system) & (turns | steps | flows) == methods


def test_five_samples_of_delay_are_not_found():
    """One mode is unstable by itself."""
    system = thesis_robot(("41.5", "44.2"), BOTH, "0.01", sampling="{period: 2 ms, delay: 5}")
    with pytest.raises(np.linalg.LinAlgError, match="not stable"):
        outcome(search_conewise_modes, system, optimize_rate=False)


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


def test_too_many_conditions_leave_roundings_out(monkeypatch):
    system = bouncing_in_turns(rounded=True)
    assert found(search_periodic_quadratic, system).covers_rounding
    monkeypatch.setattr(graphs, "MOST_ROUNDED", 1)
    assert not found(search_periodic_quadratic, system).covers_rounding


def test_roundings_that_leave_no_room_are_left_out():
    sampling = "{period: 2 ms, outer_period: 4 ms, delay: 0}"
    system = thesis_robot(("41.5", "44.2"), BOTH, "0.01", sampling=sampling)
    assert certify(system).evidence.covers_rounding


def test_numbers_beyond_floating_point():
    assert certify(doubled_in_turns(4, 10**400)).verdict is Verdict.INCONCLUSIVE


def test_a_stable_mode_of_one_stay_need_not_decrease_on_the_way():
    """The period shrinks to 0.934; in the form of a, the flow of a rises for a while."""
    a, b = (np.array(rows, float) for rows in (A, B))
    radius = np.abs(np.linalg.eigvals(expm(b * 1.1) @ expm(a * 1.7))).max()
    assert radius == pytest.approx(0.934, abs=1e-3)
    found = certify(timed(("0", "0")), limits=Limits(optimize_rate=False))
    assert found.verdict == "proved"
    assert found.evidence.stays.leaving == ("a", "b")
