"""T. Ando and M.-H. Shih, "Simultaneous contractibility", SIAM Journal on Matrix Analysis and
Applications 19(2), 1998.

The pair [[1, 0], [1, 0]], [[0, 1], [0, -1]] has joint spectral radius 1, but its best quadratic
bound is sqrt(2). Scaled by c it is stable iff c < 1, and quadratically iff c < 0.7071....
"""

from .known import never_contradict, settle


def test_quadratic_below_the_scale_of_the_bound():
    # The contraction cannot be better than c sqrt(2).
    rate = settle("ando-shih-0.70").evidence.rate
    assert 2 * (7 / 10) ** 2 <= rate**2 < 1


def test_stable_without_a_quadratic_function_is_not_refuted():
    never_contradict("ando-shih-0.99")
