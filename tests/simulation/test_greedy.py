"""The greedy adversary keeps to what contact and clock allow, and stays below proved bounds."""

from fractions import Fraction
from itertools import groupby, pairwise

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.reporting.evidence.functions import step_norms
from nrs_design.reporting.evidence.offers import offer_of
from nrs_design.simulation.greedy import greedy_run, relative_norms, slowest
from nrs_design.simulation.norms import quadratic_norm
from nrs_design.simulation.switched import all_modes, transition_matrices
from tests.proof.systems import bouncing_in_turns, doubled_in_turns, genuine
from tests.simulation.systems import reset
from tests.simulation.systems import system as modes


def test_every_mode_takes_its_turn():
    system = doubled_in_turns(3)
    norm = [lambda x: np.abs(x[..., 0])] * 3
    run = greedy_run(system, norm, np.ones(1), 1.0, 7)
    assert run.mode.tolist() == [0, 1, 1, 0, 1, 1, 0]
    assert run.state[:, 0] == pytest.approx([1, 2, 1.5, 1.125, 2.25, 1.6875, 1.265625, 2.53125])
    assert relative_norms(run, norm) == pytest.approx(run.state[:, 0])


def test_contact_decides_which_modes_are_possible():
    system = bouncing_in_turns()
    norms = [lambda x: np.linalg.norm(x, axis=-1)] * 2
    run = greedy_run(system, norms, np.array([-3.0, 1.0]), 1.0, 60)
    names = [all_modes(system).modes[k].name for k in run.mode]
    for t, (name, x) in enumerate(zip(names, run.state, strict=False)):
        assert name.startswith("fall") == (x[-1] <= 0)
        assert (name in system.clock.first) == (t % 2 == 0)
    assert {"fall", "fall on", "rest"} <= set(names)


@pytest.mark.parametrize("kept", [False, True])
def test_no_run_is_above_a_proved_bound(kept):
    system, evidence = genuine("periodic-quadratic, kept" if kept else "periodic-quadratic")
    norms, rng = step_norms(offer_of(evidence).forms, system), np.random.default_rng(3)
    for _ in range(20):
        run = greedy_run(system, norms, rng.standard_normal(2), 1.0, 60)
        allowed = float(evidence.rate) ** run.time * (1 + 1e-9)
        assert (relative_norms(run, norms) <= allowed).all()
    assert all_modes(system).contact is None


def test_adversary_is_at_least_as_bad_as_any_single_mode():
    norm, x = quadratic_norm(np.diag([1.0, 5.0])), np.array([1.0, 0.0])
    dayawansa_martin = modes([[-1, -1], [1, -1]], [[-1, -5], [1, -1]])
    run = greedy_run(dayawansa_martin, norm, x, 0.1, 1)
    for mode in range(2):
        single = transition_matrices(dayawansa_martin, 0.1)[mode] @ x
        assert relative_norms(run, norm)[-1] >= norm(single) / norm(x)


# Geromel and Colaneri (2006), and a third mode.
TRIPLE = ([[0, 1], [-10, -1]], [[0, 1], ["-1/10", "-1/2"]], [[0, 1], [-1, "-1/5"]])
EUCLIDEAN = [quadratic_norm(np.eye(2))] * 3


def stays_of(switching, steps=400):
    """Mode and number of steps, each of 50 ms, of every stay."""
    run = greedy_run(modes(*TRIPLE, switching=switching), EUCLIDEAN, np.ones(2), 0.05, steps)
    return [(mode, len(list(group))) for mode, group in groupby(run.mode.tolist())]


def test_dwell_times_and_allowed_switches_are_kept():
    ring = (("m0", "m1"), ("m1", "m2"), ("m2", "m0"))
    found = stays_of(Switching(Fraction(1, 2), ring))
    assert len(found) > 3
    assert all(count >= 10 for _, count in found[:-1])
    assert all((a + 1) % 3 == b for (a, _), (b, _) in pairwise(found))


def test_a_mode_is_left_where_it_must_be():
    found = stays_of(Switching(stays=(("m0", Stay(Fraction("0.3"), Fraction(1))),)))
    assert all(6 <= count <= 20 for mode, count in found[:-1] if mode == 0)


def test_it_finds_the_growth_of_ruled_switching():
    grows = modes([[-1, 10], [0, -1]], [[-1, 0], [10, -1]], switching=Switching(Fraction(1, 10)))
    run = greedy_run(grows, EUCLIDEAN[:2], np.ones(2), 0.05, 200)
    assert relative_norms(run, EUCLIDEAN[:2])[-1] > 10


def test_the_worst_of_several_resets_is_taken():
    both = (reset("m0", "m1", [[1]]), reset("m0", "m1", [[3]]))
    system = modes(
        [["1/2"]],
        [["1/2"]],
        time=Time.DISCRETE,
        switching=Switching(resets=both, transitions=(("m0", "m1"),)),
    )
    run = greedy_run(system, quadratic_norm(np.eye(1)), np.ones(1), 1.0, 3)
    # Half of it, and three times that at the switch.
    assert max(run.state[1:, 0] / run.state[:-1, 0]) == pytest.approx(1.5)


def test_slowest_is_the_direction_that_keeps_most():
    still = modes([[0, 0], [0, -1]])
    x = slowest(still, quadratic_norm(np.eye(2)), np.eye(2), 0.1, 5)
    assert x.tolist() == [1, 0]
