"""The pattern search, on objectives whose minimum is known."""

import numpy as np
import pytest

from nrs_design.design.pattern_search import Points, local_minima, refine


def start_at(u, v, slope=0.0, step=(0.05, 0.05)):
    u = np.atleast_1d(np.asarray(u, dtype=float))
    v = np.atleast_1d(np.asarray(v, dtype=float))
    return Points(u, v, np.array(step), np.full(len(u), slope), 0)


def test_sheared_pattern_follows_a_valley_with_kinked_walls():
    def valley(u, v):
        return 50 * np.abs(v - 0.2 - 0.437 * u) + u

    found = refine(valley, start_at(0.9, 0.2 + 0.437 * 0.9, slope=0.437), 1e-6)
    assert found.u[0] == pytest.approx(0, abs=1e-6)
    stalled = refine(valley, start_at(0.9, 0.2 + 0.437 * 0.9), 1e-6)
    assert stalled.u[0] > 0.5


def test_local_minima_of_a_small_table():
    table = np.array([[1.0, 3.0, np.inf], [3.0, 4.0, 3.0], [np.inf, 5.0, 2.0]])
    assert np.argwhere(local_minima(table)).tolist() == [[0, 0], [2, 2]]
