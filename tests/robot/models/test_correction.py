"""Correction coefficients (thesis 3.4 and 3.5)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.robot.models import correction
from nrs_design.robot.models.correction import (
    DEPTH_SINES,
    TABLE_3_5,
    correct,
    correction_coefficients,
    tilt_tables,
    to_csv,
)


def test_table_for_the_controller(robot):
    (table,) = tilt_tables(robot, np.radians([-40.0, 0.0]), DEPTH_SINES)
    lines = to_csv(table).splitlines()
    assert lines[0].split(",")[:4] == ["theta4_deg", "K1", "K2", "K3"]
    assert [float(number) for number in lines[1].split(",")] == pytest.approx(
        [-40, *table.mean_ratio[0], *table.least_squares[0]], abs=1e-6
    )
    assert len(lines) == 3


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


def test_tables_of_several_groups_of_motions_are_those_of_each(robot, monkeypatch):
    """To the last bit, and a motion that is in both is moved once."""
    tilts = np.radians([-40.0, 0.0])
    apart = [tilt_tables(robot, tilts, group)[0] for group in (DEPTH_SINES, TABLE_3_5)]
    moved = []
    holds = correction.gravity_torque
    monkeypatch.setattr(correction, "gravity_torque", lambda *at: moved.append(at) or holds(*at))
    together = tilt_tables(robot, tilts, DEPTH_SINES, TABLE_3_5)
    for one, other in zip(together, apart, strict=True):
        assert (one.mean_ratio == other.mean_ratio).all()
        assert (one.least_squares == other.least_squares).all()
    assert len(moved) == len(tilts) * len({*DEPTH_SINES, *TABLE_3_5})
    row = correction_coefficients(robot.tilted(tilts[0]), TABLE_3_5)
    assert (together[1].mean_ratio[0] == row.mean_ratio).all()
