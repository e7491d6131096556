"""The pattern search, on objectives whose minimum is known."""

import numpy as np
import pytest

from nrs_design.design.pattern_search import Points, local_minima, refine, snap


def start_at(u, v, slope=0.0, step=(0.05, 0.05)):
    u = np.atleast_1d(np.asarray(u, dtype=float))
    v = np.atleast_1d(np.asarray(v, dtype=float))
    return Points(u, v, np.array(step), np.full(len(u), slope), 0)


def test_smooth_minimum_is_found_from_every_start():
    found = refine(
        lambda u, v: (u - 0.3) ** 2 + 2 * (v - 0.62) ** 2, start_at([0, 0.9], [1, 0.1]), 1e-6
    )
    assert found.u == pytest.approx([0.3, 0.3], abs=1e-4)
    assert found.v == pytest.approx([0.62, 0.62], abs=1e-4)
    assert found.evaluations % 25 == 0


def test_sheared_pattern_follows_a_valley_with_kinked_walls():
    def valley(u, v):
        return 50 * np.abs(v - 0.2 - 0.437 * u) + u

    found = refine(valley, start_at(0.9, 0.2 + 0.437 * 0.9, slope=0.437), 1e-6)
    assert found.u[0] == pytest.approx(0, abs=1e-6)
    stalled = refine(valley, start_at(0.9, 0.2 + 0.437 * 0.9), 1e-6)
    assert stalled.u[0] > 0.5


def test_held_coordinate_stays():
    found = refine(lambda u, v: u + (v - 0.5) ** 2, start_at(0.7, 0.1, step=(0.0, 0.05)), 1e-6)
    assert found.u[0] == 0.7
    assert found.v[0] == pytest.approx(0.5, abs=1e-4)


def test_forbidden_region_is_not_entered():
    found = refine(lambda u, v: np.where(u > 0.25, u + v, np.inf), start_at(0.8, 0.8), 1e-6)
    assert found.u[0] > 0.25
    assert (found.u[0], found.v[0]) == pytest.approx((0.25, 0.0), abs=1e-3)


def test_snap_moves_onto_an_edge_only_where_it_costs_nothing():
    u, v, costs = snap(lambda u, v: u**9 + (v - 0.995) ** 2, np.array([0.005]), np.array([0.995]))
    assert (u[0], v[0], costs[0]) == (0.0, 0.995, 0.0)


def test_local_minima_of_a_small_table():
    table = np.array([[1.0, 3.0, np.inf], [3.0, 4.0, 3.0], [np.inf, 5.0, 2.0]])
    assert np.argwhere(local_minima(table)).tolist() == [[0, 0], [2, 2]]
