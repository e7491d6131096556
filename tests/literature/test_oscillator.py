"""A. L. Zelentsovsky, "Nonquadratic Lyapunov functions for robust stability analysis of linear
uncertain systems", IEEE Transactions on Automatic Control 39(1), 1994.

x'' + x' + (2 + k) x = 0 with k jumping between 0 and kbar. A common quadratic Lyapunov function
shows stability up to kbar = 3.82; the true limit is 6.98513.
"""

from fractions import Fraction

import pytest

from nrs_design.search.certify import Limits, certify

from .known import given


def oscillator(kbar):
    stiff = str(-2 - Fraction(kbar))
    return given("oscillator", [[["0", "1"], ["-2", "-1"]], [["0", "1"], [stiff, "-1"]]])


def test_not_quadratic_just_above_the_circle_criterion():
    # Re(1/(s^2 + s + 2)) >= -1/(1 + 2 sqrt(2)) on the axis, and 1 + 2 sqrt(2) < 3.829.
    found = certify(oscillator("3.829"))
    assert (found.verdict, found.common_quadratic) == ("proved", "impossible")


@pytest.mark.parametrize("kbar", ["5", "6"])
def test_stable_between_the_two_bounds(kbar):
    found = certify(oscillator(kbar))
    assert (found.verdict, found.common_quadratic) == ("proved", "impossible")


def test_limit_of_stability():
    """The true limit is 6.98513: refuted just above, and nothing wrong just below."""
    assert certify(oscillator("6.986")).verdict == "refuted"
    below = certify(oscillator("6.985"), limits=Limits(max_degree=6))
    assert below.verdict != "refuted"
    assert below.common_quadratic == "impossible"
