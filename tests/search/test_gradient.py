"""The reference iteration of Liberzon and Tempo (2004), thesis 5.21-5.28."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from nrs_design.errors import DesignError
from nrs_design.proof.mode import Time
from nrs_design.search.balance import own_norms
from nrs_design.search.certification import Limits
from nrs_design.search.certify import certify
from nrs_design.search.family import Family
from nrs_design.search.gradient import (
    PER_ROUND,
    find_by_gradient,
    iterate_gradient,
)
from nrs_design.search.gradient_settings import Coordinates, Gradient, Order
from nrs_design.search.method import Method
from nrs_design.thesis import thesis
from nrs_design.thesis.switching import impedance_rows
from nrs_design.work import Allowance, NotAffordableError
from tests.support import dayawansa_martin, family, holds

PAIR = np.array([[[-1.0, -1.0], [1.0, -1.0]], [[-1.0, -5.0], [0.2, -1.0]]])
WORSE = np.array([PAIR[0], [[-1.0, -6.0], [1 / 6, -1.0]]])
# Ando and Shih (1998) at scale 0.7: there is a common quadratic function iff the scale is below
# 1/sqrt(2).
STEPS = np.array([[[0.7, 0.0], [0.7, 0.0]], [[0.0, 0.7], [0.0, -0.7]]])
EASY_STEPS = 0.8 * STEPS


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


@pytest.mark.parametrize("order", Order)
@pytest.mark.parametrize(
    ("matrices", "time"), [(PAIR, Time.CONTINUOUS), (EASY_STEPS, Time.DISCRETE)]
)
def test_ended_means_every_inequality_holds(matrices, time, order):
    result = iterate_gradient(matrices, time, Gradient(order=order))
    assert result.updates > 0
    assert np.linalg.eigvalsh(result.Q)[0] > 0
    assert all(largest(A, result.Q, time) <= 1e-9 for A in matrices)


@pytest.mark.parametrize("time", Time)
def test_one_update_by_hand(time):
    """Thesis 5.24 and 5.25, and in discrete time with the gradient of lambda_max(A'QA - Q + I)."""
    matrices = {Time.CONTINUOUS: PAIR, Time.DISCRETE: STEPS}[time]
    told = []
    settings = Gradient(1.9, 0.3, max_updates=1, tell=lambda *step: told.append(step))
    iterate_gradient(matrices, time, settings, 1)
    Q, A = own_norms(matrices[1:2], time)[0], matrices[0]
    half = Q @ A
    excess = half + half.T if time is Time.CONTINUOUS else A.T @ Q @ A - Q
    values, vectors = np.linalg.eigh(excess + np.eye(2))
    v, x = values[-1], vectors[:, -1]

    def change(dQ):
        image = dQ @ A
        return x @ (image + image.T if time is Time.CONTINUOUS else A.T @ dQ @ A - dQ) @ x

    units = [
        np.array(rows, float) for rows in ([[1, 0], [0, 0]], [[0, 1], [1, 0]], [[0, 0], [0, 1]])
    ]
    a, b, c = (change(unit) for unit in units)
    gradient = np.array([[a, b / 2], [b / 2, c]])
    norm = np.linalg.norm(gradient)
    stepped = Q - (1.9 * v + 0.3 * norm) / norm**2 * gradient
    values, vectors = np.linalg.eigh(stepped)
    after = (vectors * np.maximum(values, 0)) @ vectors.T
    assert told[0] == (0, pytest.approx(max(largest(M, Q, time) for M in matrices)))
    assert told[1] == (1, pytest.approx(max(largest(M, after, time) for M in matrices)))


@pytest.mark.parametrize("order", Order)
@pytest.mark.parametrize("limit", [0, 10])
def test_gives_up(limit, order):
    settings = Gradient(max_updates=limit, order=order)
    result = iterate_gradient(WORSE, Time.CONTINUOUS, settings)
    assert result.Q is None
    assert result.updates == limit


def test_it_stops_when_its_work_is_used_up():
    allowance = Allowance(20 * PER_ROUND)
    with pytest.raises(NotAffordableError, match="stopped"):
        iterate_gradient(WORSE, Time.CONTINUOUS, Gradient(), allowance=allowance)
    assert allowance.charged < 22 * PER_ROUND


def test_the_random_order_hangs_on_its_seed():
    def way(seed):
        told = []
        settings = Gradient(order="random", seed=seed, tell=lambda *step: told.append(step))
        iterate_gradient(PAIR, Time.CONTINUOUS, settings)
        return told

    assert way(1) == way(1)
    assert way(1) != way(2)


def test_history_begins_at_zero_ends_below_and_thins_out():
    told = []
    settings = Gradient(radius=1e-3, max_updates=3000, tell=lambda *step: told.append(step))
    result = iterate_gradient(PAIR, Time.CONTINUOUS, settings)
    updates = [step for step, _ in told]
    assert updates[:101] == list(range(101))
    assert updates == sorted(set(updates))
    assert len(updates) < 400
    assert updates[-1] == result.updates
    assert (told[-1][1] <= 1e-9) == (result.Q is not None)


# In the states of the thesis neither pair ends: see `tests/thesis/test_gradient.py`.
@pytest.mark.parametrize("order", Order)
@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("pair", [withdrawal, tool])
@pytest.mark.parametrize("coordinates", ["balanced", "mean-norm"])
def test_pairs_of_the_thesis_end_soon_in_other_coordinates(pair, start, order, coordinates):
    settings = Gradient(
        start=pair().modes[start].name, order=order, coordinates=coordinates, max_updates=3000
    )
    result = find_by_gradient(Family.of(pair(), gradient=settings))
    assert result.Q is not None
    assert result.updates < 300


@pytest.mark.parametrize("coordinates", Coordinates)
def test_what_it_finds_in_any_coordinates_is_for_the_modes(coordinates):
    system = family([[-1, -100], [Fraction(1, 100), -1]], [[-1, -500], [Fraction(1, 500), -1]])
    gradient = Gradient(coordinates=coordinates, max_updates=5000)
    found = certify(system, Method.GRADIENT, Limits(optimize_rate=False, gradient=gradient))
    if coordinates == Coordinates.GIVEN:
        assert found.verdict == "inconclusive"
    else:
        assert holds(system, found.evidence)


def test_equal_modes_and_blocks_keep_their_start():
    one, two = [[-1, -1], [1, -1]], [[-1, -5], [Fraction(1, 5), -1]]
    ends = []
    for modes, start in (((one, two), "m2"), ((two, one), "m1"), ((one, two, two), "m3")):
        told = []
        system = family(*modes)
        names = [mode.name for mode in system.modes]
        gradient = Gradient(start=names[int(start[1]) - 1], tell=lambda *s, t=told: t.append(s))
        limits = Limits(optimize_rate=False, gradient=gradient)
        certify(system, Method.GRADIENT, limits)
        ends.append(told[0][1])
    assert ends[0] == pytest.approx(ends[1]) == pytest.approx(ends[2])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"relaxation": 2.1}, "relaxation 2.1"),
        ({"relaxation": float("nan")}, "relaxation nan"),
        ({"radius": 0.0}, "radius 0.0"),
        ({"radius": float("inf")}, "radius inf"),
        ({"seed": -1}, "seed -1"),
        ({"max_updates": -1}, "limit of updates -1"),
        ({"order": "backwards"}, "order backwards"),
        ({"coordinates": "polar"}, "states polar"),
    ],
)
def test_settings_out_of_range(change, message):
    with pytest.raises(DesignError, match=message) as caught:
        replace(Gradient(), **change)
    assert caught.value.remedy.startswith("give one ")


@pytest.mark.parametrize(
    ("method", "gradient", "message"),
    [
        (Method.GRADIENT, Gradient(start="nobody"), "cannot start with mode 'nobody'"),
        (Method.LMI, Gradient(radius=2.0), "lmi has no use for settings"),
    ],
)
def test_settings_that_would_not_be_kept(method, gradient, message):
    with pytest.raises(DesignError, match=message):
        certify(dayawansa_martin(5), method, Limits(gradient=gradient))
