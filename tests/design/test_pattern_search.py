"""The pattern search, on objectives whose minimum is known."""

import numpy as np
import pytest

from nrs_design.design.pattern_search import Points, lowest_minima, lowest_on_square, refine


def start_at(u, v, slope=0.0, step=(0.05, 0.05)):
    u = np.atleast_1d(np.asarray(u, dtype=float))
    v = np.atleast_1d(np.asarray(v, dtype=float))
    return Points(u, v, np.array(step), np.full(len(u), slope))


def test_sheared_pattern_follows_a_valley_with_kinked_walls():
    def valley(u, v):
        return 50 * np.abs(v - 0.2 - 0.437 * u) + u

    found = refine(valley, start_at(0.9, 0.2 + 0.437 * 0.9, slope=0.437))
    assert found.u[0] == pytest.approx(0, abs=1e-5)
    stalled = refine(valley, start_at(0.9, 0.2 + 0.437 * 0.9))
    assert stalled.u[0] > 0.5


def test_the_lowest_minima_of_a_few_values():
    values = np.array([2.0, 3.0, np.inf, 5.0, 1.0, 1.5, np.inf, 4.0])
    assert lowest_minima(values, 2).tolist() == [4, 0]
    assert lowest_minima(values, 4).tolist() == [4, 0, 7]


BOTH = (True, True)


def search_square(objective, free):
    return lowest_on_square(objective, objective, free)


def test_minimum_inside_the_allowed_region():
    u, v, value = search_square(lambda u, v: (u - 0.3) ** 2 + 2 * (v - 0.62) ** 2, BOTH)
    assert (u, v) == pytest.approx((0.3, 0.62), abs=1e-3)
    assert value == pytest.approx(0, abs=1e-6)


def test_minimum_on_a_slanted_edge_of_the_allowed_region():
    """On u + 2 v >= 1, the point nearest to the origin is (1/5, 2/5)."""

    def cost(u, v):
        return np.where(u + 2 * v >= 1, u**2 + v**2, np.inf)

    u, v, value = search_square(cost, BOTH)
    assert value == pytest.approx(0.2, abs=1e-5)
    assert (u, v) == pytest.approx((0.2, 0.4), abs=5e-3)


def test_minimum_on_a_curved_edge():
    """On u v >= 1/4, the smallest u + v is 1, at (1/2, 1/2)."""
    _, _, value = search_square(lambda u, v: np.where(u * v >= 0.25, u + v, np.inf), BOTH)
    assert value == pytest.approx(1, abs=1e-4)


def test_an_edge_of_the_square_is_reached_exactly():
    u, v, _ = search_square(lambda u, v: u - v, BOTH)
    assert (u, v) == (0.0, 1.0)


def test_a_held_coordinate_stays():
    u, v, _ = search_square(lambda u, v: u + (v - 0.5) ** 2, (False, True))
    assert u == 0.0
    assert v == pytest.approx(0.5, abs=1e-4)
    u, v, _ = search_square(lambda u, v: (u - 0.5) ** 2 + v, (True, False))
    assert u == pytest.approx(0.5, abs=1e-4)
    assert v == 0.0


def test_nothing_allowed_is_infinite():
    assert search_square(lambda u, v: np.full(len(u), np.inf), BOTH)[2] == np.inf
