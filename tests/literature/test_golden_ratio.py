"""R. Jungers, "The Joint Spectral Radius: Theory and Applications", Springer, 2009.

The pair [[1, 1], [0, 1]], [[1, 0], [1, 1]] has the golden ratio 1.6180... as its joint spectral
radius (reached by alternating), and a quadratic norm shows it. Its inverse is 0.61803....
"""

from itertools import pairwise
from math import sqrt

from .known import settle


def test_scaled_below_the_inverse_of_the_golden_ratio():
    rate = settle("golden-0.618").evidence.rate
    assert 0.618 * (1 + sqrt(5)) / 2 <= rate < 1


def test_scaled_above_it_grows_by_alternating():
    steps = settle("golden-0.6181").evidence.steps
    assert [dwell for _, dwell in steps] == [1] * len(steps)
    assert all(a != b for (a, _), (b, _) in pairwise(steps))
