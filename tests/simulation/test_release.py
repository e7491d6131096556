"""An axis that is pressed in and let go, against what can be computed by hand."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Switching
from nrs_design.simulation.release import Outputs, certified, simulate_release
from tests.proof.systems import family

# The velocity v and the deflection d: d' = v and v' = -k d - c v.
LAST = np.array([0.0, 1.0])
ROWS = Outputs(np.array([[0.0, 4.0]]), np.array([[1.0, 0.0]]), LAST, LAST, 2.0, 1.0)


def springs(*numbers, **rules):
    """Return modes with a stiffness and a damping each."""
    rows = ([[-c, -k], [1, 0]] for k, c in numbers)
    system = family(*rows, switching=Switching(**rules))
    return replace(system, states=("v", "delta [rad]"))


def test_a_run_begins_at_rest_at_the_largest_force():
    run = simulate_release(springs((1, 3)), ROWS, None)
    assert run.state[0] == pytest.approx([0.0, 0.5])
    # Overdamped by itself: d = a exp(-s t) + b exp(-f t).
    fast, slow = (3 + np.sqrt(5)) / 2, (3 - np.sqrt(5)) / 2
    by_hand = 0.5 * (fast * np.exp(-slow * run.time) - slow * np.exp(-fast * run.time))
    assert run.state[:, 1] == pytest.approx(by_hand / (fast - slow), abs=1e-9)


def test_the_adversary_is_worse_than_either_mode_alone():
    soft, stiff = (1, 1), (3, 1)
    both = simulate_release(springs(soft, stiff), ROWS, None)
    alone = [simulate_release(springs(mode), ROWS, None) for mode in (soft, stiff)]
    largest = [np.abs(run.state[:, 0]).max() for run in (both, *alone)]
    assert largest[0] >= max(largest[1:]) - 1e-9
    assert set(both.mode.tolist()) == {0, 1}


def test_rules_let_one_mode_hold():
    ruled = springs((1, 1), (3, 1), dwell_time=Fraction(1))
    assert len(set(simulate_release(ruled, ROWS, None).mode.tolist())) == 1


def test_a_certified_bound_holds_along_the_run_and_is_reached_by_some_start():
    # A'Q + QA = -2 (1/3) Q is not needed to be exact: the rate is below that of this Q.
    Q = np.array([[1.0, 1.0], [1.0, 3.0]])
    A = np.array([[-2.0, -1.0], [1.0, 0.0]])
    inverse = np.linalg.inv(np.linalg.cholesky(Q))
    rate = -0.5 * np.linalg.eigvalsh(inverse @ (A.T @ Q + Q @ A) @ inverse.T).max()
    assert rate > 0
    run = simulate_release(springs((1, 2)), ROWS, Q)
    for rows in (ROWS.force, ROWS.velocity):
        bound = certified(rows, Q, ROWS.start, rate, run.time)
        assert (np.abs(run.state @ rows.T).max(axis=1) <= bound + 1e-12).all()
        worst = np.linalg.solve(Q, rows[0])
        assert certified(rows, Q, worst, rate, np.zeros(1))[0] == pytest.approx(rows[0] @ worst)


def test_a_sampled_run_begins_with_what_was_measured_and_counts_seconds():
    rows = [["1/2", "0", "0"], ["0", "0", "4"], ["0", "1/8", "1/2"]]
    states = ("omega [rad/s]", "F 1 before [N*m]", "delta [rad]")
    sampled = replace(family(rows, time=Time.DISCRETE), states=states, sample_time=Fraction(1, 500))
    velocity, last = np.array([[1.0, 0.0, 0.0]]), np.array([0.0, 0.0, 1.0])
    outputs = Outputs(np.array([[0.0, 0.0, 4.0]]), velocity, last, last, 2.0, 1.0, (1,))
    run = simulate_release(sampled, outputs, None)
    # Half of the deflection stays, and an eighth of the torque that was measured is added.
    assert run.state[0] == pytest.approx([0.0, 2.0, 0.5])
    assert run.state[1] == pytest.approx([0.0, 2.0, 0.5])
    assert run.time[:3] == pytest.approx([0.0, 0.002, 0.004])


def test_a_run_that_grows_is_cut_and_overflows_nothing():
    grows = family([[0, 0], [0, 10]], time=Time.DISCRETE)
    run = simulate_release(grows, ROWS, None)
    assert np.abs(run.state[:, 1]).max() == pytest.approx(10 * 0.5 * 10)
    assert len(run.time) == len(run.mode) + 1
