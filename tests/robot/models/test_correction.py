"""Correction coefficients (thesis 3.4 and 3.5)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.robot.models.correction import (
    DEPTH_SINES,
    correct,
    correction_coefficients,
    tilt_table,
)


def test_coefficients_over_the_tilt(robot):
    table = tilt_table(robot, np.radians([-40.0, 0.0]), DEPTH_SINES)
    assert table.mean_ratio.shape == (2, 3)
    assert table.mean_ratio[0, 2] == pytest.approx(2.162, abs=6e-4)
    row = correction_coefficients(robot.tilted(table.tilt[0]), DEPTH_SINES)
    assert (table.least_squares[0] == row.least_squares).all()


@given(st.lists(st.floats(0.5, 3), min_size=3, max_size=3))
def test_a_pure_factor_is_found_exactly(factors):
    t = np.random.default_rng(0).uniform(0.5, 2, (50, 3))
    found = correct((t * factors, t))
    assert found.mean_ratio == pytest.approx(factors)
    assert found.least_squares == pytest.approx(factors)
    assert found.least_squares_error == pytest.approx(0, abs=1e-12)


def test_least_squares_leaves_the_least_error():
    rng = np.random.default_rng(1)
    T, t = rng.normal(size=(2, 100, 3))
    found = correct((T, t))
    for step in (-0.1, 0.1):
        other = np.sqrt(np.mean((T - (found.least_squares + step) * t) ** 2, axis=0))
        assert np.all(found.least_squares_error < other)
    assert np.all(found.least_squares_error <= found.mean_ratio_error)
