"""A quadratic function along runs in each mode."""

from fractions import Fraction

import numpy as np
import pytest

from nrs_design.proof.mode import Time
from nrs_design.reporting.figures.value import draw_value
from tests.support import matrix


def lines(modes, time, line=None, start=None):
    named = {f"m{k}": matrix(A) for k, A in enumerate(modes, 1)}
    (axes,) = draw_value(named, matrix([[1]]), time, start, line).axes
    return {drawn.get_label(): drawn.get_xydata().T for drawn in axes.get_lines()}


def test_it_falls_as_the_mode_does():
    """Of x' = -x and V = x^2, V(t) = exp(-2 t) V(0)."""
    found = lines([[["-1"]]], Time.CONTINUOUS, ("proved bound", Fraction(1)))
    t, V = found["m1"]
    assert pytest.approx(np.exp(-2 * t), rel=1e-9) == V
    assert found["proved bound"][1] == pytest.approx(V, rel=1e-9)


def test_steps_are_counted():
    found = lines([[["1/2"]], [["-1/3"]]], Time.DISCRETE, start=(Fraction(3),))
    k, V = found["m1"]
    assert k[:3].tolist() == [0, 1, 2]
    assert V[:3].tolist() == [1, 0.25, 0.0625]
    assert found["m2"][1][1] == pytest.approx(1 / 9)
