import math

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.simulation.norms import quadratic_norm
from nrs_design.simulation.switched import (
    fine_step,
    mode_eigenvalues,
    mode_rates,
    sampled_direction,
    single_mode_system,
    transition_matrices,
    worst_direction,
)
from tests.simulation.systems import system

# Narendra and Balakrishnan (1994), commuting modes.
COMMUTING = system([[-1, 1], [-1, -1]], [[-2, 3], [-3, -2]])


def test_simulation_is_the_matrix_exponential():
    first = transition_matrices(COMMUTING, 1.5)[0] @ np.array([1.0, 0.0])
    assert first == pytest.approx(math.exp(-1.5) * np.array([math.cos(1.5), -math.sin(1.5)]))


def test_slowest_direction_decays_at_the_smallest_rate():
    Q = np.array([[2.0, 0.5], [0.5, 1.0]])
    x = worst_direction(COMMUTING, Q)
    assert x @ Q @ x == pytest.approx(1.0)
    slope = [2 * x @ Q @ np.array(mode.A.floats()) @ x for mode in COMMUTING.modes]
    assert max(slope) == pytest.approx(-2 * mode_rates(COMMUTING, Q).min())


def test_rates_of_rotations_are_their_real_parts_and_in_steps_singular_values():
    assert mode_rates(COMMUTING, np.eye(2)) == pytest.approx([1.0, 2.0])
    discrete = system([[0, 2], [0, 0]], [[0, 0], [0, 0]], time=Time.DISCRETE)
    assert mode_rates(discrete, np.eye(2)) == pytest.approx([2.0, 0.0])


def test_step_resolves_the_fastest_eigenvalue():
    assert fine_step(system([[-50]])) == pytest.approx(0.002)
    assert fine_step(system([[0]])) == 0.1
    assert fine_step(system([["-1/2"]], time=Time.DISCRETE)) == 1.0


def test_eigenvalues_of_every_mode():
    assert np.sort_complex(mode_eigenvalues(COMMUTING)[1]) == pytest.approx([-2 - 3j, -2 + 3j])


def test_sampled_direction_is_near_the_slowest_one():
    norm = quadratic_norm(np.diag([1.0, 9.0]))
    x = sampled_direction(system([[-1, 0], [0, -5]]), norm, 0.01)
    assert norm(x) == pytest.approx(1.0)
    assert abs(x[0]) > 0.99


def test_a_mode_alone_keeps_its_own_states():
    unequal = system([[-1]], [[0, 1], [-2, -1]])
    assert single_mode_system(unequal, 0).states == ("x1",)
    assert single_mode_system(unequal, 1).order == 2
    assert [len(values) for values in mode_eigenvalues(unequal)] == [1, 2]
