from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.mode import Time
from nrs_design.reporting.figures.complex_plane import draw_eigenvalues
from nrs_design.reporting.figures.value import draw_value
from nrs_design.reporting.figures.view import disk, half_plane
from tests.support import matrix

FAR = np.array([-1 + 3j, -1 - 3j, -20000, -2 + 3j, -2 - 3j, -4])
parts = st.floats(-1e6, 1e6).filter(lambda x: x == 0 or abs(x) > 1e-6)
points = st.lists(st.builds(complex, parts, parts), min_size=1, max_size=8)


def test_a_far_pole_does_not_squeeze_the_rest():
    figure = draw_eigenvalues(["a", "b"], [FAR[:3], FAR[3:]], Time.CONTINUOUS, None)
    (axes,) = figure.axes
    x = axes.transAxes.inverted().transform(axes.transData.transform([[r.real, 0] for r in FAR]))[
        :, 0
    ]
    assert ((x > 0) & (x < 1)).all()
    assert x[0] - x[5] > 0.25
    assert "logarithmic beyond ±4.2" in axes.get_xlabel()
    labels = [label.get_text() for label in axes.get_xticklabels()]
    assert "−1000" in labels
    assert len(labels) == len(set(labels))
    assert axes.get_yscale() == "linear"


def test_poles_of_one_size_are_drawn_on_linear_axes():
    view = half_plane(np.array([-1 + 3j, -1 - 3j, -9]))
    assert view.real.bend is None
    assert view.imaginary.bend is None
    assert view.real.note == ""


@pytest.mark.parametrize("largest", [0.9, 300.0])
def test_the_unit_circle_is_round(caplog, largest):
    figure = draw_eigenvalues(["a"], [np.array([0.5, -0.2, largest])], Time.DISCRETE, 0.9)
    assert caplog.messages == []
    (axes,) = figure.axes
    corners = axes.transData.transform([[1, 0], [0, 1], [0, 0]])
    assert corners[0, 0] - corners[2, 0] == pytest.approx(corners[1, 1] - corners[2, 1], rel=0.02)
    assert axes.get_xlim()[1] > largest


@given(points)
def test_nothing_is_hidden(values):
    z = np.array(values)
    for view in (half_plane(z), disk(z)):
        assert view.real.low < z.real.min()
        assert z.real.max() < view.real.high
        assert view.imaginary.low < z.imag.min()
        assert z.imag.max() < view.imaginary.high


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
