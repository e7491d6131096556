"""The integral that is cut off: the same bits as without a clamp within it, and never beyond it."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.laws import IntegralForce, PositionControl
from nrs_design.controllers.replica import step
from nrs_design.controllers.step_law import StepFrame, StepLimits, build_law

PERIOD, CLAMP = Fraction(1, 500), Fraction(1, 64)
LAWS = {
    "position": PositionControl().discretize(PERIOD, "exact"),
    "hold": IntegralForce(Fraction(1, 32), Fraction(1, 2)).discretize(PERIOD, "exact"),
}
FRAME = StepFrame(Fraction(100_000), Fraction(1_000_000))
FREE = build_law(FRAME, LAWS, Fraction(7, 8))
CUT = build_law(replace(FRAME, limits=StepLimits(integral=CLAMP)), LAWS, Fraction(7, 8))


def after(law, mode, **values):
    given = {value.name: np.zeros(1, np.float32) for value in law.values}
    given |= {name: np.array([value], np.float32) for name, value in values.items()}
    made = step(law, np.array([mode], np.uint32), given)
    assert made.valid[0]
    return made.outputs["command"][0], made.states["integral"][0]


@given(st.integers(0, 1), st.floats(-1 / 64, 1 / 64, width=32), st.floats(-50, 50, width=32))
def test_it_is_cut_off_and_nothing_else_changes(mode, integral, torque):
    command, free = after(FREE, mode, integral=integral, torque=torque)
    same, cut = after(CUT, mode, integral=integral, torque=torque)
    assert same.tobytes() == command.tobytes()
    limit = np.float32(float(CLAMP))
    assert cut.tobytes() == np.clip(free, -limit, limit).tobytes()


def test_it_comes_back_from_the_clamp_at_once():
    """Pushed for a second, and then pulled: without a clamp that takes a second, too."""
    ends = []
    for law in (FREE, CUT):
        w = np.float32(0)
        for _ in range(500):
            _, w = after(law, 1, integral=w, torque=-2.0)
        count = 0
        while w > 0:
            _, w = after(law, 1, integral=w, torque=2.0)
            count += 1
        ends.append(count)
    assert ends[0] == pytest.approx(500, abs=2)
    assert ends[1] <= 9
