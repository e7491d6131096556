"""Proportional force control (thesis 6.3.3.1)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.design.force_loop import design_force_gain, force_loop_response
from nrs_design.design.transfer import TransferFunction
from nrs_design.errors import DesignError
from tests.design.motion_loops import EXACT, PRINTED, SOFT

THIRD_ORDER = TransferFunction((800.0,), (1.0, 27.0, 240.0, 800.0))


def test_published_gain_does_not_give_the_stated_criteria():
    # Thesis 6.33 derives Kp = 0.02 from zeta = 0.707, wn = 40.297; the poles say otherwise.
    response = force_loop_response(EXACT, SOFT, 0.02)
    assert response.damping_ratio == pytest.approx(0.741, abs=5e-4)
    assert response.natural_frequency == pytest.approx(54.9, abs=0.05)


def test_stated_criteria_hold_as_the_gain_vanishes():
    response = force_loop_response(EXACT, SOFT, 0.0)
    assert response.damping_ratio == pytest.approx(0.707, abs=5e-4)
    assert response.natural_frequency == pytest.approx(40.24, abs=0.01)


def test_design_finds_the_published_gain_from_its_damping_ratio():
    assert design_force_gain(EXACT, SOFT, 0.741) == pytest.approx(0.02, rel=0.02)
    assert design_force_gain(PRINTED, SOFT, 0.707) == pytest.approx(0.0045, abs=5e-5)


@given(zeta=st.floats(0.7073, 0.999), stiffness=st.floats(1, 500))
def test_designed_gain_really_gives_the_damping_ratio(zeta, stiffness):
    gain = design_force_gain(EXACT, stiffness, zeta)
    assert force_loop_response(EXACT, stiffness, gain).damping_ratio == pytest.approx(zeta)
    # Only the product of gain and stiffness counts.
    assert gain * stiffness == pytest.approx(design_force_gain(EXACT, 1.0, zeta), rel=1e-6)


def test_design_returns_the_smallest_of_two_gains():
    # Damping falls first and rises later: s^2 + 2 s + 1 + c (0.2 s + 1).
    motion = TransferFunction((0.2, 1.0), (1.0, 2.0, 1.0))
    gain = design_force_gain(motion, 1.0, 0.8)
    scan = np.linspace(0, gain * (1 - 1e-6), 200)[1:]
    damping = [force_loop_response(motion, 1.0, float(k)).damping_ratio for k in scan]
    assert min(damping) > 0.8
    # (2 + 0.2 c)^2 = 4 zeta^2 (1 + c)
    roots = np.roots([0.04, 0.8 - 4 * 0.64, 4 - 4 * 0.64])
    assert gain == pytest.approx(roots.real.min())
    assert roots.real.max() > gain > 0


def test_design_returns_zero_where_the_motion_loop_already_has_the_damping():
    zeta = force_loop_response(EXACT, SOFT, 0.0).damping_ratio
    assert design_force_gain(EXACT, SOFT, zeta) == 0.0


def test_third_order_motion_loop_uses_its_dominant_pair():
    gain = design_force_gain(THIRD_ORDER, 10.0, 0.4)
    response = force_loop_response(THIRD_ORDER, 10.0, gain)
    assert response.damping_ratio == pytest.approx(0.4)
    pair = [p for p in response.poles if p.imag > 0]
    assert abs(pair[0]) == pytest.approx(response.natural_frequency)


@pytest.mark.parametrize("zeta", [0.3, 0.7])
def test_unreachable_damping_names_what_is_reachable(zeta):
    with pytest.raises(DesignError, match="no force gain") as caught:
        design_force_gain(EXACT, SOFT, zeta)
    assert caught.value.remedy == "gains reach 0.70717 to 1"


def test_a_single_pole_counts_twice():
    lag = TransferFunction((1.0,), (0.1, 1.0))
    found = force_loop_response(lag, SOFT, 0.02)
    assert found.damping_ratio == pytest.approx(1.0)
    assert found.natural_frequency == pytest.approx((1 + 0.02 * SOFT) / 0.1)


def test_an_unstable_loop_is_refused():
    with pytest.raises(DesignError, match="unstable with Kp = 10"):
        force_loop_response(THIRD_ORDER, SOFT, 10.0)
