from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.simulation.switched import (
    eigenvalues,
    fine_step,
    mode_rates,
    norms,
    simulate_switching,
    unstable_run,
    worst_direction,
    worst_switching,
)
from nrs_design.switched.matrix import RationalMatrix
from nrs_design.switched.system import Mode, SwitchedSystem, Time


def system(*matrices, time=Time.CONTINUOUS):
    modes = tuple(Mode(f"m{i}", RationalMatrix.from_rows(A)) for i, A in enumerate(matrices))
    states = tuple(f"x{i + 1}" for i in range(len(matrices[0])))
    return SwitchedSystem("test", time, states, modes, ())


# Narendra and Balakrishnan (1994), commuting modes.
COMMUTING = system([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])


def test_simulation_is_the_matrix_exponential():
    run = simulate_switching(COMMUTING, np.array([0, 0, 0]), np.array([1.0, 0.0]), 0.5)
    expected = math.exp(-1.5) * np.array([math.cos(1.5), -math.sin(1.5)])
    assert run.state[-1] == pytest.approx(expected)
    assert run.time.tolist() == [0.0, 0.5, 1.0, 1.5]


def test_commuting_modes_do_not_depend_on_the_order():
    ends = [
        simulate_switching(COMMUTING, np.array(order), np.array([1.0, 2.0]), 0.1).state[-1]
        for order in ([0, 1, 0, 1], [1, 1, 0, 0])
    ]
    assert ends[0] == pytest.approx(ends[1])


def test_mode_rates_of_rotations_are_their_real_parts():
    assert mode_rates(COMMUTING, np.eye(2)) == pytest.approx([1.0, 2.0])


def test_mode_rates_in_discrete_time_are_singular_values():
    discrete = system([[0, 2], [0, 0]], [[0, 0], [0, 0]], time=Time.DISCRETE)
    assert mode_rates(discrete, np.eye(2)) == pytest.approx([2.0, 0.0])


@given(st.floats(1e-6, 1e6))
def test_mode_rates_do_not_depend_on_the_scale_of_Q(factor):
    Q = np.array([[2.0, 0.5], [0.5, 1.0]])
    assert mode_rates(COMMUTING, factor * Q) == pytest.approx(mode_rates(COMMUTING, Q))


def test_slowest_direction_decays_at_the_smallest_rate():
    Q = np.array([[2.0, 0.5], [0.5, 1.0]])
    x = worst_direction(COMMUTING, Q)
    assert x @ Q @ x == pytest.approx(1.0)
    slope = [2 * x @ Q @ np.array(mode.A.floats()) @ x for mode in COMMUTING.modes]
    assert max(slope) == pytest.approx(-2 * mode_rates(COMMUTING, Q).min())


def test_adversary_is_at_least_as_bad_as_any_single_mode():
    Q, x = np.diag([1.0, 5.0]), np.array([1.0, 0.0])
    dayawansa_martin = system([[-1, -1], [1, -1]], [[-1, -5], [1, -1]])
    run = worst_switching(dayawansa_martin, Q, x, 0.1, 1)
    for mode in range(2):
        alone = simulate_switching(dayawansa_martin, np.array([mode]), x, 0.1)
        assert norms(run, Q)[-1] >= norms(alone, Q)[-1]


def test_norms_start_at_one():
    run = simulate_switching(COMMUTING, np.array([0]), np.array([3.0, 4.0]), 1.0)
    assert norms(run, np.eye(2)) == pytest.approx([1.0, math.exp(-1)])


def test_step_resolves_the_fastest_eigenvalue():
    assert fine_step(system([[-50]])) == pytest.approx(0.002)
    assert fine_step(system([[0]])) == 0.1
    assert fine_step(system([["-1/2"]], time=Time.DISCRETE)) == 1.0


def test_eigenvalues_of_every_mode():
    assert np.sort_complex(eigenvalues(COMMUTING)[1]) == pytest.approx([-2 - 3j, -2 + 3j])


@pytest.mark.parametrize("time", list(Time))
def test_unstable_run_grows_a_hundredfold(time):
    unstable = system([[-3, 0], [0, "3/2"]], [[2, 0], [0, "3/2"]], time=time)
    run = unstable_run(unstable, 1)
    assert set(run.mode.tolist()) == {1}
    assert norms(run, np.eye(2))[-1] >= 99


def test_marginal_run_keeps_its_size():
    run = unstable_run(system([[0, -1], [1, 0]]), 0)
    assert norms(run, np.eye(2)) == pytest.approx(1.0)
    assert run.time[-1] == pytest.approx(62.8)
