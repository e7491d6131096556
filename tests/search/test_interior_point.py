"""The interior-point method: known optima, a general solver, and how it ends without an answer."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.search.interior_point import Cones, maximize_last, step_cost
from nrs_design.search.sdp import symmetric_basis

# A positive value is good enough within this factor of the largest one.
GOOD = 2.0


def smallest_eigenvalue(M):
    """The largest t with ``M - t I >= 0``, in the form of the method."""
    cones = Cones(M[None], -np.eye(len(M))[None, None])
    return maximize_last(cones, np.array([-10.0 * np.abs(M).sum() - 1.0]))[-1]


def test_a_negative_optimum_is_met():
    # Eigenvalues 2 +- sqrt(2) and 2, less 5.
    M = np.array([[2.0, 1.0, 0.0], [1.0, 2.0, -1.0], [0.0, -1.0, 2.0]]) - 5 * np.eye(3)
    assert smallest_eigenvalue(M) == pytest.approx(-3 - np.sqrt(2), abs=1e-9)


def test_a_positive_optimum_is_met_within_a_factor():
    M = np.array([[2.0, 1.0, 0.0], [1.0, 2.0, -1.0], [0.0, -1.0, 2.0]])
    best = 2 - np.sqrt(2)
    assert best / GOOD <= smallest_eigenvalue(M) < best


def random_problem(rng, n, m):
    """Margin form of a family: Q, I - Q, and the decrease of m modes less t."""
    basis, identity = symmetric_basis(n), np.eye(n)
    matrices = rng.standard_normal((m, n, n)) - rng.uniform(0.3, 2.5) * np.sqrt(n) * identity
    half = basis[:, None] @ matrices
    images = np.zeros((len(basis) + 1, m + 2, n, n))
    images[:-1, 0], images[:-1, 1] = basis, -basis
    images[:-1, 2:] = -(half + half.swapaxes(-1, -2))
    images[-1, 2:] = -identity
    constant = np.zeros((m + 2, n, n))
    constant[1] = identity
    start = np.zeros(len(basis) + 1)
    start[:-1] = [np.trace(E) / 2 for E in basis]
    start[-1] = -100.0 * n
    return matrices, Cones(constant, images), start


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.integers(1, 4))
def test_the_answer_is_strictly_feasible(seed, n, m):
    _, cones, start = random_problem(np.random.default_rng(seed), n, m)
    y = maximize_last(cones, start)
    assert y[-1] >= start[-1]
    assert np.linalg.eigvalsh(cones.at(y)).min() > 0


def test_it_ends_when_it_is_told_to_with_a_feasible_point():
    _, cones, start = random_problem(np.random.default_rng(1), 4, 2)
    values = []
    for steps in range(4):
        answers = iter([True] * steps + [False])
        y = maximize_last(cones, start, lambda answers=answers: next(answers))
        assert np.linalg.eigvalsh(cones.at(y)).min() > 0
        values.append(y[-1])
    assert values[0] == start[-1]
    assert values == sorted(values)


def test_a_step_is_predicted_to_take_more_the_larger_it_is():
    small, large = step_cost(56, 10, 10), step_cost(2081, 4, 64)
    # Measured with one thread: 64 states and two modes take seconds a step, and 0.3 GB of images.
    assert small.work < 0.01
    assert 1 < large.work < 60
    assert large.memory > 8 * 2081 * 4 * 64**2
