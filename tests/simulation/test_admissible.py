from __future__ import annotations

from fractions import Fraction
from itertools import groupby, pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.simulation.admissible import active_norms, admissible_run, norm_ratio
from tests.simulation.systems import reset, system

# Geromel and Colaneri (2006).
PAIR = ([[0, 1], [-10, -1]], [[0, 1], ["-1/10", "-1/2"]])
UNIT = {f"m{i}": np.eye(2) for i in range(3)}


def stays(run):
    """Mode and number of steps of every stay."""
    return [(mode, len(list(group))) for mode, group in groupby(run.mode.tolist())]


@settings(max_examples=20, deadline=None)
@given(st.fractions(Fraction(1, 10), 4, max_denominator=20))
def test_dwell_time_is_kept(dwell):
    run = admissible_run(system(*PAIR, switching=Switching(dwell)), UNIT, 0.05, 300)
    step = run.time[1]
    assert len(run.mode) >= 300
    assert all(count * step >= float(dwell) * (1 - 1e-9) for _, count in stays(run)[:-1])


def test_steps_divide_the_dwell_time():
    run = admissible_run(system(*PAIR, switching=Switching(Fraction(1))), UNIT, 0.3, 200)
    assert run.time[1] == pytest.approx(0.25)


def test_only_allowed_switches_are_made():
    ring = Switching(transitions=(("m0", "m1"), ("m1", "m2"), ("m2", "m0")))
    modes = (*PAIR, [[0, 1], [-1, "-1/5"]])
    run = admissible_run(system(*modes, switching=ring), UNIT, 0.05, 400)
    order = [mode for mode, _ in stays(run)]
    assert len(order) > 3
    assert all((a + 1) % 3 == b for a, b in pairwise(order))


def test_resets_between_states_of_different_size():
    # The large mode decays faster than its state is mapped into the small one.
    rules = Switching(
        transitions=(("m0", "m1"), ("m1", "m0")),
        resets=(reset("m0", "m1", [[1, 0]]), reset("m1", "m0", [[1], [2]])),
    )
    unequal = system([[-9, 0], [0, -9]], [[-1]], switching=rules)
    functions = {"m0": np.eye(2), "m1": np.eye(1)}
    run = admissible_run(unequal, functions, 0.01, 100)
    assert run.state.shape == (len(run.mode) + 1, 2)
    small = run.state[:-1][run.mode == 1]
    assert len(small)
    assert (small[:, 1] == 0).all()
    large = np.flatnonzero((run.mode[1:] == 0) & (run.mode[:-1] == 1)) + 1
    assert len(large)
    assert run.state[large, 1] == pytest.approx(2 * run.state[large, 0])
    values = active_norms(unequal, run, functions)
    assert values[0] == 1.0
    assert values[large[0]] > values[large[0] - 1]


def test_adversary_finds_the_growth_of_free_switching():
    grows = system([[-1, 10], [0, -1]], [[-1, 0], [10, -1]], switching=Switching(Fraction(1, 10)))
    run = admissible_run(grows, UNIT, 0.05, 200)
    assert active_norms(grows, run, UNIT)[-1] > 10


def test_ratio_of_norms():
    assert norm_ratio({"a": np.diag([1.0, 4.0]), "b": np.diag([16.0, 2.0])}) == pytest.approx(4.0)


def test_dwell_times_by_mode_and_modes_that_must_be_left():
    rules = Switching(
        stays=(("m0", Stay(Fraction("0.3"), Fraction(1))), ("m1", Stay(Fraction(2), Fraction(3))))
    )
    run = admissible_run(system(*PAIR, switching=rules), UNIT, 0.05, 400)
    instants, modes = np.cumsum([0, *(count for _, count in stays(run))]), stays(run)
    assert len(modes) > 4
    for k, (mode, _) in enumerate(modes[:-1]):
        time = run.time[instants[k + 1]] - run.time[instants[k]]
        low, high = ((0.3, 1.0), (2.0, 3.0))[mode]
        assert low - 1e-9 <= time <= high + 1e-9


def test_a_mode_that_must_be_left_after_a_step():
    rules = Switching(stays=(("m0", Stay(Fraction(1), Fraction(1))),))
    pair = ([[2, 0], [0, 2]], [["1/4", 0], [0, "1/4"]])
    run = admissible_run(system(*pair, time=Time.DISCRETE, switching=rules), UNIT, 1.0, 50)
    assert all(count == 1 for mode, count in stays(run) if mode == 0)
    assert len(stays(run)) > 20


def test_the_worst_of_several_resets_is_taken():
    both = (reset("m0", "m1", [[1]]), reset("m0", "m1", [[3]]))
    rules = Switching(Fraction(1), resets=both)
    unit = {f"m{i}": np.eye(1) for i in range(2)}
    run = admissible_run(
        system([["1/2"]], [["1/2"]], time=Time.DISCRETE, switching=rules), unit, 1.0, 40
    )
    # Half of it, and three times that at the switch.
    assert run.state[1, 0] == pytest.approx(1.5 * run.state[0, 0])
