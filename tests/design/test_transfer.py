"""Transfer functions and the polynomial tools of the loop designs."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from nrs_design.design.transfer import (
    TransferFunction,
    frequencies,
    frequency_response,
    hurwitz,
    poles,
    static_gain,
    trim,
)
from tests.design.motion_loops import PRINTED
from tests.tables import rows

coefficients = st.lists(st.floats(-5, 5).map(lambda x: round(x, 3)), min_size=1, max_size=5)


def test_printed_motion_loop_has_unit_gain_and_a_damped_pair():
    assert PRINTED.order == 2
    assert static_gain(PRINTED) == 1.0
    upper, lower = poles(PRINTED)
    assert upper == pytest.approx(-28.348 + 28.552j, abs=1e-3)
    assert lower == upper.conjugate()


def test_frequency_response_at_one_hand_computed_point():
    # 1/(s + 1) at s = j: (1 - j)/2.
    tf = TransferFunction((1.0,), (1.0, 1.0))
    assert frequency_response(tf, 1.0) == pytest.approx(0.5 - 0.5j)
    assert frequency_response(tf, [[0.0, 1.0]]).shape == (1, 2)


def test_integrator_has_infinite_static_gain():
    assert static_gain(TransferFunction((2.0,), (1.0, 0.0))) == math.inf


def test_trim_keeps_the_last_coefficient():
    assert trim((0.0, 0.0, 3.0, 0.0)) == (3.0, 0.0)
    assert trim((0.0, 0.0)) == (0.0,)


@pytest.mark.parametrize(
    ("polynomial", "expected"), rows(__file__, "test_hurwitz_on_textbook_polynomials")
)
def test_hurwitz_on_textbook_polynomials(polynomial, expected):
    assert bool(hurwitz(polynomial)) is expected


def test_hurwitz_keeps_the_shape_and_mixes_degrees():
    rows = np.array([[[1, 3, 3, 1], [0, 1, 1, 1]], [[0, 0, 1, -1], [1, 1, 1, 9]]])
    assert hurwitz(rows).tolist() == [[True, True], [False, False]]


@given(st.lists(coefficients, min_size=1, max_size=1), st.integers(0, 2))
def test_hurwitz_agrees_with_computed_roots(rows, zeros):
    polynomial = [0.0] * zeros + rows[0]
    assume(any(polynomial))
    rightmost = np.roots(polynomial).real.max(initial=-math.inf)
    assume(abs(rightmost) > 1e-6)
    assert bool(hurwitz(polynomial)) == (rightmost < 0)


def test_frequencies_are_roots_of_positive_ones_also_of_double_ones():
    for polynomial, roots in (
        (np.poly([-1, 3, 2, 1 + 1j, 1 - 1j, 0]).real, [2, 3]),
        (np.poly([2, 2]), [2, 2]),
        (np.array([0.0, 0.0, 1.0]), []),
    ):
        found = frequencies(polynomial[None])[0] ** 2
        assert sorted(found[~np.isnan(found)]) == pytest.approx(roots, rel=1e-6)
