from fractions import Fraction

import pytest

from nrs_design.models.actuator import Actuator
from nrs_design.models.motion_loop import close_motion_loop

ACTUATOR = Actuator(Fraction("4.8417e-4"), Fraction("0.0351"))


def test_motion_loop_of_the_thesis():
    """Thesis 6.1, exact coefficients: (0.9974 s + 56.82) / (0.0351 s^2 + 1.9974 s + 56.82)."""
    loop = close_motion_loop(ACTUATOR, Fraction("117359.43"), Fraction(2060))
    assert [float(c) for c in loop.numerator] == pytest.approx([0.9974, 56.822], rel=1e-4)
    assert [float(c) for c in loop.denominator] == pytest.approx([0.0351, 1.9974, 56.822], rel=1e-4)


def test_unit_gain_at_rest():
    loop = close_motion_loop(ACTUATOR, Fraction(3), Fraction(7))
    assert loop.numerator[-1] == loop.denominator[-1]
    assert loop.denominator[1] - loop.numerator[0] == 1
