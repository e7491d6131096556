"""Graphs that searches draw: what they decide, and where they apply."""

import numpy as np
import pytest
from scipy.linalg import expm

from nrs_design.certificates.certificate import Verdict
from nrs_design.reporting.evidence.norms import largest_norm
from nrs_design.reporting.evidence.offers import offer_of
from nrs_design.search import graphs
from nrs_design.search.certify import Limits, certify
from nrs_design.search.graphs import (
    search_conewise_modes,
    search_periodic_quadratic,
    search_together,
)
from nrs_design.search.ladder import applicable_methods
from nrs_design.search.method import Method
from nrs_design.spec import parse_spec
from nrs_design.switched.assemble import assemble_matrices
from tests.proof.graphs import shape_of
from tests.proof.systems import (
    bouncing,
    bouncing_in_steps,
    bouncing_in_turns,
    dayawansa_martin,
    doubled_in_turns,
)
from tests.search.support import found, outcome, thesis_robot

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
    evidence, why = outcome(search_conewise_modes, system, optimize_rate=False)
    assert evidence is None
    assert why


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


@pytest.mark.slow
def test_runs_through_contact_and_flight_never_leave_the_bound():
    """1,000 runs of 300 samples; the stiffness is anywhere in its range at every sample."""
    system = thesis_robot(("20", "42.5"), BOTH, "0.01", sampling="{period: 2 ms, delay: 2}")
    evidence = found(search_conewise_modes, system, optimize_rate=False)
    norm = largest_norm(offer_of(evidence).forms, system.order)
    maps = {mode.name: np.array(mode.A.floats()) for mode in system.modes}
    free = [np.array(mode.A.floats()) for mode in system.contact.free if "E-min" in mode.name]
    ends = [[maps[f"{c}/soft/k-{end}/E-min"] for end in ("min", "max")] for c in ("c0", "c1")]
    rng = np.random.default_rng(0)
    x = rng.standard_normal((1000, system.order)) / norm(np.eye(system.order))
    bounced = np.zeros(len(x), dtype=int)
    for _ in range(300):
        chosen, share = rng.integers(2, size=len(x)), rng.uniform(size=(len(x), 1, 1))
        low, high = (np.array([pair[k] for pair in ends])[chosen] for k in (0, 1))
        touching = x[:, -1:, None] > 0
        A = np.where(touching, (1 - share) * low + share * high, np.array(free)[chosen])
        after = (A @ x[:, :, None])[:, :, 0]
        assert (norm(after) < float(evidence.rate) * norm(x)).all()
        bounced += (after[:, -1] > 0) != touching[:, 0, 0]
        # Moved along the ray, as a run goes on for ever.
        x = after / norm(after)[:, None]
    assert np.median(bounced) >= 1


def test_a_stable_mode_of_one_stay_need_not_decrease_on_the_way():
    """The period shrinks to 0.934; in the form of a, the flow of a rises for a while."""
    a, b, stays = [[0.13, 1.22], [-1.13, -0.56]], [[-0.77, -1.5], [0.96, 1.31]], ("1.7", "1.1")
    text = f"""\
kind: switched-system
name: timed
time: continuous
modes:
  - {{name: a, A: {a}}}
  - {{name: b, A: {b}}}
switching:
  dwell_time: {{a: {stays[0]} s, b: {stays[1]} s}}
  longest_dwell_time: {{a: {stays[0]} s, b: {stays[1]} s}}
"""
    period = expm(np.array(b) * float(stays[1])) @ expm(np.array(a) * float(stays[0]))
    radius = np.abs(np.linalg.eigvals(period)).max()
    assert radius == pytest.approx(0.934, abs=1e-3)
    found = certify(assemble_matrices(parse_spec(text)), limits=Limits(optimize_rate=False))
    assert found.verdict == "proved"
    assert found.evidence.stays.leaving == ("a", "b")
