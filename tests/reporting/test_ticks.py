import numpy as np
import pytest

from nrs_design.reporting.style import format_tick, new_axes, styled
from tests.tables import rows


@pytest.mark.parametrize(
    ("value", "step", "text"), rows(__file__, "test_ticks_are_written_in_full")
)
def test_ticks_are_written_in_full(value, step, text):
    assert format_tick(value, step) == text


@styled
def drawn(values, scale="linear"):
    figure, axes = new_axes()
    axes.plot(values, values)
    axes.set_xscale(scale)
    axes.set_yscale(scale)
    return figure


@pytest.mark.parametrize(
    "values", [1000 + np.array([1e-4, 3e-4]), np.array([1e-9, 4e-9]), np.array([2e8, 9e8])]
)
def test_no_axis_has_an_offset_or_a_common_factor(values):
    (axes,) = drawn(values).axes
    for axis in (axes.xaxis, axes.yaxis):
        assert axis.get_offset_text().get_text() == ""
        labels = [label.get_text() for label in axis.get_ticklabels()]
        assert len(set(labels)) == len(labels) > 2


def test_labels_of_a_logarithmic_axis_are_no_formulas():
    """A short axis has labels between the powers."""
    (axes,) = drawn(np.array([1e-6, 1e6]), "log").axes
    labels = [label.get_text() for label in axes.get_xticklabels()]
    assert "10⁻⁶" in labels
    assert not any("$" in label for label in labels)
    (axes,) = drawn(np.array([1.5, 7.0]), "log").axes
    shown = [t.get_text() for t in axes.get_xticklabels(which="both") if t.get_text()]
    assert sorted(set(shown) - {"1", "10"}) == ["2", "3", "4", "6"]
