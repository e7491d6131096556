"""W. P. Dayawansa and C. F. Martin, "A converse Lyapunov theorem for a class of dynamical systems
which undergo switching", IEEE Transactions on Automatic Control 44(4), 1999.

The pair [[-1, -1], [1, -1]], [[-1, -a], [1/a, -1]] has a common quadratic Lyapunov function iff
a < 3 + 2 sqrt(2) = 5.8284..., and is stable under arbitrary switching iff a < 11.2608....
"""

import pytest

from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method

from .known import given, known, settle


def pair(a: str):
    numerator, _, denominator = a.partition("/")
    inverse = f"{denominator or 1}/{numerator}"
    return given("pair", [[["-1", "-1"], ["1", "-1"]], [["-1", f"-{a}"], [inverse, "-1"]]])


def test_stable_without_a_quadratic_function():
    evidence = settle("dayawansa-martin-6").evidence
    assert 2 * evidence.degree == known("dayawansa-martin-6").degree


def test_unstable_beyond_the_limit():
    assert settle("dayawansa-martin-12").evidence.kind == "growing-sequence"


@pytest.mark.parametrize(
    ("a", "degree"), [("8", 4), ("9", 4), pytest.param("10", 8, marks=pytest.mark.slow)]
)
def test_higher_degrees_reach_further(a, degree):
    found = certify(pair(a))
    assert (found.verdict, found.common_quadratic) == ("proved", "impossible")
    assert 2 * found.evidence.degree == degree


@pytest.mark.parametrize("a", ["112/10", "1126/100"])
def test_never_refuted_below_the_limit(a):
    """The signal with the largest growth is found by search, and must not grow too early."""
    assert certify(pair(a), Method.PERIOD).verdict == "inconclusive"


@pytest.mark.slow
def test_close_to_the_limit_is_proved_by_a_high_degree():
    # The limit is 11.2608; a unit of time that follows the lifted entries loses this proof.
    found = certify(pair("56/5"), Method.POLYNOMIAL, Limits(max_degree=48))
    assert found.verdict == "proved"
