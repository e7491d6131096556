"""A. L. Zelentsovsky, "Nonquadratic Lyapunov functions for robust stability analysis of linear
uncertain systems", IEEE Transactions on Automatic Control 39(1), 1994.

x'' + x' + (2 + k) x = 0 with k jumping between 0 and kbar. A common quadratic Lyapunov function
shows stability up to kbar = 3.82; the true limit is 6.98513.
"""

from fractions import Fraction

from nrs_design.certificates.certify import certify

from .known import given, never_contradict, settle


def oscillator(kbar):
    stiff = str(-2 - Fraction(kbar))
    return given("oscillator", [[["0", "1"], ["-2", "-1"]], [["0", "1"], [stiff, "-1"]]])


def test_quadratic_up_to_the_published_bound():
    settle("oscillator-3.82")


def test_nothing_wrong_beyond_the_limit_of_stability():
    never_contradict("oscillator-7")


def test_never_quadratic_just_above_the_circle_criterion():
    # Re(1/(s^2 + s + 2)) >= -1/(1 + 2 sqrt(2)) on the axis, and 1 + 2 sqrt(2) < 3.829.
    found = certify(oscillator("3.829"))
    assert found.common_quadratic != "exists"
    assert found.verdict != "refuted"
