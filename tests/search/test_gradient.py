"""The reference iteration of Liberzon and Tempo (2004), thesis 5.21-5.28."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.search import gradient as module
from nrs_design.search.balance import own_norms
from nrs_design.search.certify import certify
from nrs_design.search.family import Family
from nrs_design.search.method import Method
from nrs_design.search.work import Allowance, NotAffordableError
from nrs_design.thesis import thesis
from nrs_design.thesis.switching import impedance_rows
from tests.support import family, holds

PAIR = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -5.0], [0.2, -1.0]]])
WORSE = np.array([PAIR[0], [[-1.0, -6.0], [1 / 6, -1.0]]])
# Ando and Shih (1998) at scale 0.7: there is a common quadratic function iff the scale is below
# 1/sqrt(2).
STEPS = np.array([[[0.7, 0.0], [0.7, 0.0]], [[0.0, 0.7], [0.0, -0.7]]])
EASY_STEPS = 0.8 * STEPS


def iterate(matrices, time, settings):
    return module.iterate_gradient(matrices, time, settings, Allowance())


def largest(A, Q, time=Time.CONTINUOUS):
    excess = A.T @ Q + Q @ A if time is Time.CONTINUOUS else A.T @ Q @ A - Q
    return np.linalg.eigvalsh(excess + np.eye(len(Q)))[-1]


def withdrawal(coordinates="force"):
    """Thesis 6.3.2.2 with the right signs."""
    rows = (impedance_rows(thesis.SOFT, "0.01", Bt, coordinates) for Bt in ("2.15", "1.04"))
    return family(*rows)


def tool():
    """Thesis 6.4.1 with the right digits."""
    stiff = impedance_rows(thesis.STIFF, "0.01", "2.11", "force")
    return family(stiff, impedance_rows(thesis.SOFT, "0.01", "2.15", "force"))


@pytest.mark.parametrize("order", module.Order)
@pytest.mark.parametrize(
    ("matrices", "time"), [(PAIR, Time.CONTINUOUS), (EASY_STEPS, Time.DISCRETE)]
)
def test_ended_means_every_inequality_holds(matrices, time, order):
    result = iterate(matrices, time, module.Gradient(order=order))
    assert result.updates > 0
    assert np.linalg.eigvalsh(result.Q)[0] > 0
    assert all(largest(A, result.Q, time) <= 1e-9 for A in matrices)


def stepped(A, Q, time, v, x, relaxation, radius):
    """Thesis 5.24 and 5.25; the gradient is of lambda_max, by changes of single entries."""

    def change(dQ):
        image = dQ @ A
        return x @ (image + image.T if time is Time.CONTINUOUS else A.T @ dQ @ A - dQ) @ x

    units = np.array([[[1, 0], [0, 0]], [[0, 1], [1, 0]], [[0, 0], [0, 1]]], float)
    a, b, c = map(change, units)
    gradient = np.array([[a, b / 2], [b / 2, c]])
    norm = np.linalg.norm(gradient)
    values, vectors = np.linalg.eigh(Q - (relaxation * v + radius * norm) / norm**2 * gradient)
    return (vectors * np.maximum(values, 0)) @ vectors.T


@pytest.mark.parametrize(
    ("matrices", "time"), [(PAIR, Time.CONTINUOUS), (EASY_STEPS, Time.DISCRETE)]
)
def test_every_update_by_hand(matrices, time):
    result = iterate(matrices, time, module.Gradient(1.9, 0.3, start=1))
    Q, i, updates = own_norms(matrices[1:2], time)[0], 0, 0
    while max(largest(A, Q, time) for A in matrices) > 0:
        A = matrices[i % 2]
        excess = A.T @ Q + Q @ A if time is Time.CONTINUOUS else A.T @ Q @ A - Q
        values, vectors = np.linalg.eigh(excess + np.eye(2))
        if values[-1] > 0:
            Q = stepped(A, Q, time, values[-1], vectors[:, -1], 1.9, 0.3)
            updates += 1
        i += 1
    assert result.updates == updates
    np.testing.assert_allclose(result.Q, Q, rtol=1e-6)


@pytest.mark.parametrize("order", module.Order)
@pytest.mark.parametrize("limit", [0, 10])
def test_gives_up(limit, order):
    result = iterate(WORSE, Time.CONTINUOUS, module.Gradient(max_updates=limit, order=order))
    assert result.Q is None
    assert result.updates == limit


def test_it_stops_when_its_work_is_used_up():
    allowance = Allowance(20 * module.PER_ROUND)
    with pytest.raises(NotAffordableError, match="stopped"):
        module.iterate_gradient(WORSE, Time.CONTINUOUS, module.Gradient(), allowance)
    assert allowance.charged < 22 * module.PER_ROUND


# In the states of the thesis neither pair ends: see `tests/thesis/test_gradient.py`.
@pytest.mark.parametrize("order", module.Order)
@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("pair", [withdrawal, tool])
@pytest.mark.parametrize("coordinates", [module.Coordinates.BALANCED, module.Coordinates.MEAN_NORM])
def test_pairs_of_the_thesis_end_soon_in_other_coordinates(pair, start, order, coordinates):
    settings = module.Gradient(order=order, coordinates=coordinates, max_updates=3000, start=start)
    result = module.find_by_gradient(Family.of(pair()), settings)
    assert result.Q is not None
    assert result.updates < 300


@pytest.mark.parametrize("coordinates", module.Coordinates)
def test_what_it_finds_in_any_coordinates_is_for_the_modes(coordinates):
    system = family([[-1, -100], [Fraction(1, 100), -1]], [[-1, -500], [Fraction(1, 500), -1]])
    own = module.Gradient(coordinates=coordinates, max_updates=5000)
    result = module.find_by_gradient(Family.of(system), own)
    assert (result.Q is None) is (coordinates == module.Coordinates.GIVEN)
    if result.Q is not None:
        assert all(largest(A, result.Q) < 1 for A in Family.of(system).matrices)


def test_its_function_is_checked():
    system = family(*PAIR.tolist())
    assert holds(system, certify(system, Method.GRADIENT).evidence)
