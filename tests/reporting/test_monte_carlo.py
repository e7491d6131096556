"""Figures of many runs."""

from itertools import pairwise

import numpy as np
import pytest

from nrs_design.reporting.figures.monte_carlo import Spread, draw_monte_carlo


def test_a_limit_far_away_is_as_declared_and_a_bound_rounded_upward():
    peaks = np.linspace(1.31, 1.37, 20)
    spread = Spread("Largest torque [N m]", peaks, (3.6,), 30.00001, holds=True)
    (axes,) = draw_monte_carlo([spread]).axes
    title = axes.get_title(loc="right")
    assert "limit 3.6," in title
    assert title.endswith(" 30.01")


@pytest.mark.parametrize("spread", [0.0, 1e-9, 1e-7, 1e-4, 1e-2, 1.0])
def test_ticks_of_peaks_that_hardly_differ_can_be_read(spread):
    """A command of 8 deg/s is the peak of all runs, but for the last digits."""
    peaks = 8.0 + spread * np.linspace(0.0, 1.0, 30)
    figure = draw_monte_carlo([Spread("Largest velocity [deg/s]", peaks, (), None, holds=True)])
    figure.canvas.draw()
    labels = figure.axes[0].get_xticklabels()
    boxes = [label.get_window_extent() for label in labels if label.get_text()]
    assert len(boxes) >= 3
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))
