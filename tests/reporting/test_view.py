import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.mode import Time
from nrs_design.reporting.figures.complex_plane import draw_eigenvalues, show_disk, show_half_plane
from nrs_design.reporting.style import new_axes

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
    _, axes = new_axes()
    show_half_plane(axes, np.array([-1 + 3j, -1 - 3j, -9]), "1/s")
    assert (axes.get_xscale(), axes.get_yscale()) == ("linear", "linear")
    assert axes.get_xlabel() == "Real part [1/s]"


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
    for show in (show_half_plane, show_disk):
        _, axes = new_axes()
        show(axes, z, "1")
        (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
        assert left < z.real.min() <= z.real.max() < right
        assert low < z.imag.min() <= z.imag.max() < high
