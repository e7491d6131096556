"""Where a displayed admittance is passive: by hand, on the robot of the thesis, and on a grid."""

from fractions import Fraction
from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.controllers.laws import Admittance
from nrs_design.design.passivity import count_positive_roots, real_part
from nrs_design.design.passivity import passive_band as band_of
from nrs_design.models.motion_loop import MotionLoop, realize
from nrs_design.reproduction import thesis
from nrs_design.switched.cut_loop import ContinuousAxis
from tests.design.motion_loops import PLACE

ONE = Fraction(1)
LAG = MotionLoop((ONE,), (ONE, ONE))


def axis(loop):
    return ContinuousAxis((PLACE,), realize(loop))


def passive_band(loop, Mt, Bt):
    return band_of(axis(loop), Admittance(Mt, Bt), {})


def test_by_hand():
    """G = 1/(s + 1): Re (M j w + B)(j w + 1) = B - M w^2, so up to the root of B/M."""
    # The deflection adds an s to both N and D, hence an x to the real part.
    P = [c for c in real_part(axis(LAG), Admittance(Fraction(2), Fraction(8)), {}) if c]
    assert P[0] / P[1] == Fraction(-2, 8)
    band = passive_band(LAG, Fraction(2), Fraction(8))
    assert Fraction(19999, 10000) < band.passive <= 2
    assert 2 < band.broken < Fraction(20001, 10000)
    # Without inertia it is passive at every frequency.
    static = passive_band(LAG, Fraction(0), Fraction(8))
    assert (static.passive, static.broken) == (None, None)


def test_a_loop_that_pushes_back_is_not_passive_at_rest():
    band = passive_band(MotionLoop((-ONE,), (ONE, ONE)), ONE, ONE)
    assert (band.passive, band.broken) == (0, None)


@pytest.mark.parametrize(
    ("Mt", "Bt", "hertz"),
    [(1, 4, 2.263), (2, 4, 1.643), (3, 4, 1.355), (1, 8, 3.06), (3, 8, 1.880)],
)
def test_the_robot_of_the_thesis(Mt, Bt, hertz):
    """Chapter 7; 1.36 Hz and 3.06 Hz are what an independent program rounds to."""
    band = passive_band(thesis.CLOSED_LOOP, Fraction(Mt), Fraction(Bt))
    assert float(band.passive) / (2 * pi) == pytest.approx(hertz, rel=3e-3)
    assert band.passive < band.broken < band.passive * Fraction(10001, 10000)


def test_roots_are_counted_once():
    """(x - 1)^2 (x - 2) (x + 3)"""
    P = [Fraction(int(c)) for c in np.poly([1, 1, 2, -3]).round()]
    counts = [count_positive_roots(P, Fraction(end)) for end in ("1/2", "1", "3/2", "2", "9")]
    assert counts == [0, 1, 1, 2, 2]


@settings(deadline=None)
@given(
    st.lists(st.integers(1, 50), min_size=2, max_size=2),
    st.lists(st.integers(1, 50), min_size=3, max_size=3),
    st.integers(0, 20),
    st.integers(1, 20),
)
def test_against_a_grid(numerator, denominator, Mt, Bt):
    """Below the band the real part is positive, and where it is refuted it is negative."""
    loop = MotionLoop(tuple(map(Fraction, numerator)), tuple(map(Fraction, denominator)))
    band = passive_band(loop, Fraction(Mt), Fraction(Bt))

    def real(omega: np.ndarray) -> np.ndarray:
        s = 1j * omega
        return ((Mt * s + Bt) * np.polyval(denominator, s) / np.polyval(numerator, s)).real

    end = 1e3 if band.passive is None else float(band.passive)
    assert (real(np.linspace(0, end, 400)) > -1e-6 * Bt).all()
    if band.broken is not None:
        assert real(np.array([float(band.broken)]))[0] < 1e-9
