"""The rate that no proof can exceed: known joint spectral radii, and single modes."""

from math import sqrt

import pytest

from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Stay, Switching
from nrs_design.search.rate_limit import rate_limit
from tests.proof.systems import ando_shih, family, golden, must_leave


def test_the_slowest_mode_in_continuous_time():
    assert rate_limit(family([[-3, 1], [0, -2]], [[-5, 0], [0, -7]])) == pytest.approx(2)


def test_modes_of_different_sizes():
    assert rate_limit(family([[-3]], [[-2, 0], [0, -9]])) == pytest.approx(2)


@pytest.mark.parametrize("c", ["0.5", "0.9"])
def test_joint_spectral_radius_of_ando_and_shih(c):
    """It is c, which no mode has less of: both have the radius c themselves."""
    assert rate_limit(ando_shih(c)) == pytest.approx(float(c))


def test_a_product_grows_faster_than_its_factors():
    """Both factors have the radius 1/2; their product is ``[[4.25, 1], [1, 1/4]]``."""
    pair = family([["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]], time=Time.DISCRETE)
    alternating = sqrt((4.5 + sqrt(20)) / 2)
    assert rate_limit(pair) == pytest.approx(alternating)


def test_golden_ratio():
    """Blondel and Theys: the product of both has the radius c^2 (3 + sqrt 5) / 2."""
    assert rate_limit(golden(1)) == pytest.approx((1 + sqrt(5)) / 2)


def test_under_rules_only_single_modes_count():
    modes = ([["1/2", 2], [0, "1/2"]], [["1/2", 0], [2, "1/2"]])
    ruled = family(*modes, time=Time.DISCRETE, switching=Switching(dwell_time=9))
    assert rate_limit(ruled) == pytest.approx(0.5)


def test_modes_that_must_be_left_set_no_limit():
    system = must_leave(3)
    lasting = [mode.name for mode in system.lasting_modes()]
    assert 0 < len(lasting) < len(system.modes)
    assert rate_limit(system) is not None
    brief = tuple((f"m{i}", Stay(longest=1)) for i in range(2))
    assert rate_limit(family([[-1]], [[-2]], switching=Switching(stays=brief))) is None


def test_beyond_floating_point_there_is_none():
    assert rate_limit(family([[-(10**400)]], [[-1]])) is None
