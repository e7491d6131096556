"""T. Ando and M.-H. Shih, "Simultaneous contractibility", SIAM Journal on Matrix Analysis and
Applications 19(2), 1998.

The pair [[1, 0], [1, 0]], [[0, 1], [0, -1]] has joint spectral radius 1, but its best quadratic
bound is sqrt(2). Scaled by c it is stable iff c < 1, and quadratically iff c < 0.7071....
"""

from nrs_design.search.certify import Limits, certify
from nrs_design.search.method import Method
from tests.proof.graphs import shape_of

from .known import known, settle


def test_quadratic_below_the_scale_of_the_bound():
    # The contraction cannot be better than c sqrt(2).
    rate = settle("ando-shih-0.70").evidence.rate
    assert 2 * (7 / 10) ** 2 <= rate**2 < 1


def test_stable_without_a_quadratic_function():
    """One function per mode shows it, and no rate better than the joint spectral radius."""
    found = settle("ando-shih-0.99")
    assert shape_of(found.evidence) == "mode-quadratic"
    assert 0.99 <= found.evidence.rate < 1


def test_a_polynomial_function_shows_it_too():
    # The bound of degree 2d is at most sqrt(2)^(1/d) above the radius: 0.84 2^(1/4) < 1.
    pair = known("ando-shih-0.70").system
    assert certify(pair, Method.POLYNOMIAL, Limits(max_degree=4)).verdict == "proved"
