"""Margins of many loops, against python-control one by one and against a frequency grid."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.design.impedance_optimum import ImpedanceLoop
from nrs_design.design.loops import Loops, gain_extremes
from nrs_design.design.transfer import multiply
from nrs_design.models.contact import Elastic, KelvinVoigt
from tests.design.classical import displayed_impedance_at, loop_margins, open_loop
from tests.design.motion_loops import EXACT


def rows(loop, admittances):
    """Stack open loops, padded with leading zeros to one length."""
    loops = [open_loop(loop, Mt, Bt) for Mt, Bt in admittances]
    width = len(loop.motion.denominator) + 2

    def padded(p):
        return [0.0] * (width - len(p)) + list(p)

    return Loops(
        np.array([padded(tf.numerator) for tf in loops]),
        np.array([padded(tf.denominator) for tf in loops]),
    )


@settings(max_examples=25, deadline=None)
@given(
    stiffness=st.floats(3, 400),
    damping=st.one_of(st.just(0.0), st.floats(0.01, 0.5)),
    Mt=st.one_of(st.just(0.0), st.floats(1e-3, 0.5)),
    Bt=st.floats(0.1, 20),
)
def test_each_margin_is_that_of_python_control(stiffness, damping, Mt, Bt):
    loop = ImpedanceLoop(EXACT, KelvinVoigt(stiffness, damping))
    # The others of the batch have another degree, and must not matter.
    found = rows(loop, [(0.0, 2.0), (Mt, Bt), (0.01, 1.0)])
    if not found.stable[1]:
        return
    expected = loop_margins(loop, Mt, Bt)
    for values, value in (
        (found.sensitivity_peak(), expected.sensitivity_peak),
        (found.gain_margin(), expected.gain_margin),
        (found.phase_margin(), expected.phase_margin),
        (found.delay_margin(), expected.delay_margin),
        (found.disk_margin(), expected.disk_margin),
    ):
        assert values[1] == pytest.approx(value, rel=1e-5)


def test_an_unstable_loop_has_the_worst_margins():
    """Mt = 0.01, Bt = 1.04: stable up to 75.9 N m/rad."""
    unstable, stable = (
        rows(ImpedanceLoop(EXACT, Elastic(k)), [(0.01, 1.04)]) for k in (90.0, 43.0356)
    )
    assert unstable.sensitivity_peak() == [math.inf]
    for margin in (Loops.gain_margin, Loops.phase_margin, Loops.delay_margin, Loops.disk_margin):
        assert margin(unstable) == [0.0]
        assert 0 < margin(stable)[0] < math.inf


def test_a_margin_that_nothing_limits_is_infinite():
    # 0.1/(s + 1) never reaches the gain 1 nor the phase -180 degrees.
    loops = Loops(np.array([[0.0, 0.1]]), np.array([[1.0, 1.0]]))
    assert loops.gain_margin() == [math.inf]
    assert loops.phase_margin() == [math.inf]
    assert loops.delay_margin() == [math.inf]


@pytest.mark.parametrize("Mt", [0.0, 0.01, 0.2])
def test_extremes_of_the_displayed_impedance_are_those_of_a_grid(Mt):
    loop = ImpedanceLoop(EXACT, KelvinVoigt(43.0356, 0.1))
    Bt, bandwidth = 2.15, 40.0
    batch = rows(loop, [(Mt, Bt)])
    displayed = multiply(batch.numerator, np.array([[Mt, Bt]]))
    low, high = gain_extremes(displayed, batch.closed, bandwidth)
    grid = np.abs(displayed_impedance_at(loop, Mt, Bt, np.linspace(0, bandwidth, 40_001)))
    assert low[0] == pytest.approx(grid.min(), rel=1e-6)
    assert high[0] == pytest.approx(grid.max(), rel=1e-6)
    assert low[0] <= grid.min() * (1 + 1e-12)
    assert high[0] >= grid.max() * (1 - 1e-12)
