import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from nrs_design.robot.models.body import MASSLESS, point_mass, rigid_body, slender_rod

vectors = arrays(float, 3, elements=st.floats(-1, 1, allow_subnormal=False))


def test_slender_rod():
    rod = slender_rod(0.3, (0.1, 0, 0), 0.2, 0)
    assert rod.inertia == pytest.approx(np.diag([0, 1e-3, 1e-3]), abs=1e-15)
    assert rod.center_of_mass == pytest.approx([0.1, 0, 0])


@given(vectors, vectors)
def test_parameters_come_back(center, moments):
    tensor = np.diag([2.0, 2.5, 3.0]) + np.outer(moments, moments)
    body = rigid_body(1.5, center, tensor)
    assert body.center_of_mass == pytest.approx(center, abs=1e-12)
    assert body.inertia == pytest.approx(tensor, abs=1e-12)


@given(vectors, vectors, vectors)
def test_two_point_masses_are_a_dumbbell(first, second, shift):
    both = point_mass(1.0, first).plus(point_mass(3.0, second))
    assert both.center_of_mass == pytest.approx((first + 3 * second) / 4, abs=1e-12)
    apart = second - first
    reduced = 0.75 * (apart @ apart * np.eye(3) - np.outer(apart, apart))
    assert both.inertia == pytest.approx(reduced, abs=1e-12)
    quarter = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    moved = both.transform(quarter, shift)
    assert moved.center_of_mass == pytest.approx(quarter @ both.center_of_mass + shift, abs=1e-12)
    assert moved.inertia == pytest.approx(quarter @ both.inertia @ quarter.T, abs=1e-12)


def test_nothing_added_changes_nothing():
    body = slender_rod(1.0, (0.1, 0.2, 0.3), 0.4, 2)
    assert body.plus(MASSLESS) == body
    assert np.all(MASSLESS.center_of_mass == 0)
