"""Figures of many runs."""

import numpy as np

from nrs_design.reporting.figures.monte_carlo import Spread, draw_monte_carlo


def test_a_limit_far_away_is_as_declared_and_a_bound_rounded_upward():
    peaks = np.linspace(1.31, 1.37, 20)
    spread = Spread("Largest torque [N m]", peaks, (3.6,), 30.00001, holds=True)
    (axes,) = draw_monte_carlo([spread]).axes
    title = axes.get_title(loc="right")
    assert "limit 3.6," in title
    assert title.endswith(" 30.01")
