"""A bound on a quotient of polynomials over a box: by hand, a resonance, poles, and at random."""

from fractions import Fraction
from itertools import product
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.design.largest_ratio import bernstein, bound_ratio

ONE = Fraction(1)
PARABOLA = Fraction(0), Fraction(1, 2), Fraction(0)


def fractions(*numbers):
    return [Fraction(number) for number in numbers]


def test_coefficients_by_hand():
    """x^2 from 1 to 3: its values at the ends, and between them the tangents meet at x = 2: 3."""
    assert bernstein(fractions(0, 0, 1), ONE, Fraction(3)) == [1, 3, 9]


@pytest.mark.parametrize("limit", ["0.250001", "0.26"])
def test_a_parabola(limit):
    """x (1 - x) is at most 1/4, at x = 1/2, which is a vertex once the box is halved."""
    found = bound_ratio(PARABOLA, [ONE] * 3, (3,), Fraction(limit))
    assert Fraction(1, 4) <= found <= Fraction(limit)


def test_a_resonance():
    """1/((1 - x)^2 + x/100) with x from 0 to 2: highest at x = 0.995, 1/(x^2 - 1.99 x + 1)."""
    below = bernstein(fractions(1, "-1.99", 1), Fraction(0), Fraction(2))
    exact = 1 / (1 - Fraction("0.995") ** 2)
    more, less = (exact * Fraction(share) for share in ("1.0001", "0.9999"))
    assert exact <= bound_ratio([ONE] * 3, below, (3,), more) <= more
    found = bound_ratio([ONE] * 3, below, (3,), less)
    assert found is None or found >= exact


def test_a_pole_in_the_box_has_no_bound():
    below = bernstein(fractions("1/4", -1, 1), Fraction(0), ONE)
    assert bound_ratio([ONE] * 3, below, (3,), max_pieces=2000) is None
    assert bound_ratio([ONE] * 3, below, (3,), Fraction(100)) is None


def test_what_is_not_shown_in_time_is_not_claimed():
    """With no work, the coefficients of the whole box are all there is: 1/2 for 1/4."""
    found = bound_ratio(PARABOLA, [ONE] * 3, (3,), Fraction(1, 4), max_pieces=-1)
    assert found == Fraction(1, 2)


def value(coefficients, shape, point):
    """Return the mean of Bernstein coefficients at a point."""
    total = 0.0
    for at, c in zip(product(*map(range, shape)), coefficients, strict=True):
        weights = [
            comb(n - 1, i) * u**i * (1 - u) ** (n - 1 - i)
            for i, n, u in zip(at, shape, point, strict=True)
        ]
        total += float(c) * float(np.prod(weights))
    return total


@settings(deadline=None, derandomize=True, max_examples=40)
@given(st.data())
def test_no_point_is_above(data):
    shape = (3, data.draw(st.integers(2, 4)))
    size = shape[0] * shape[1]
    above, below = (
        [Fraction(n) for n in data.draw(st.lists(st.integers(1, 30), min_size=size, max_size=size))]
        for _ in range(2)
    )
    points = np.random.default_rng(1).uniform(size=(50, 2))
    ratios = [value(above, shape, point) / value(below, shape, point) for point in points]
    for limit in (None, Fraction(max(ratios)) * Fraction("1.01")):
        assert max(ratios) <= float(bound_ratio(above, below, shape, limit)) + 1e-9
