"""W. P. Dayawansa and C. F. Martin, "A converse Lyapunov theorem for a class of dynamical systems
which undergo switching", IEEE Transactions on Automatic Control 44(4), 1999.

The pair [[-1, -1], [1, -1]], [[-1, -a], [1/a, -1]] has a common quadratic Lyapunov function iff
a < 3 + 2 sqrt(2) = 5.8284..., and is stable under arbitrary switching iff a < 11.2608....
"""

import pytest

from nrs_design.certificates.certify import certify

from .known import given, never_contradict, settle


def test_quadratic_below_the_threshold():
    settle("dayawansa-martin-5")


@pytest.mark.parametrize("name", ["dayawansa-martin-6", "dayawansa-martin-12"])
def test_nothing_wrong_above_the_threshold(name):
    never_contradict(name)


@pytest.mark.parametrize("tenths", range(10, 58, 8))
def test_proved_over_the_quadratic_range(tenths):
    matrices = [[["-1", "-1"], ["1", "-1"]], [["-1", f"-{tenths}/10"], [f"10/{tenths}", "-1"]]]
    assert certify(given("pair", matrices), optimize_rate=False).verdict == "proved"


def test_never_quadratic_just_above_the_threshold():
    # 3 + 2 sqrt(2) lies between 5828/1000 and 5829/1000.
    matrices = [[["-1", "-1"], ["1", "-1"]], [["-1", "-5829/1000"], ["1000/5829", "-1"]]]
    found = certify(given("pair", matrices))
    assert found.common_quadratic != "exists"
    assert found.verdict != "refuted"
