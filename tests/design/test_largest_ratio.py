"""Bounds on a quotient of polynomials over a box: by hand, a resonance, poles, and at random."""

from fractions import Fraction
from itertools import product
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.design.largest_ratio import NEARLY, bernstein, largest_ratio

ONE = Fraction(1)


def fractions(*numbers):
    return [Fraction(number) for number in numbers]


def test_coefficients_by_hand():
    """x^2 from 1 to 3: its values at the ends, and between them the tangents meet at x = 2: 3."""
    assert bernstein(fractions(0, 0, 1), ONE, Fraction(3)) == [1, 3, 9]


def test_a_parabola():
    """x (1 - x) is at most 1/4, at x = 1/2, which is a vertex once the box is halved."""
    found = largest_ratio(fractions(0, "1/2", 0), [ONE] * 3, (3,))
    assert found.below == Fraction(1, 4)
    assert found.at == (Fraction(1, 2),)
    assert Fraction(1, 4) <= found.above <= Fraction(1, 4) * (1 + NEARLY)


def test_a_resonance():
    """1/((1 - x)^2 + x/100) with x from 0 to 2: highest at x = 0.995, 1/(x^2 - 1.99 x + 1)."""
    below = bernstein(fractions(1, "-1.99", 1), Fraction(0), Fraction(2))
    found = largest_ratio([ONE] * 3, below, (3,))
    exact = 1 / (1 - Fraction("0.995") ** 2)
    assert found.below <= exact <= found.above <= found.below * (1 + NEARLY)
    assert abs(2 * found.at[0] - Fraction("0.995")) < Fraction(1, 100)


def test_a_pole_in_the_box_has_no_bound():
    below = bernstein(fractions("1/4", -1, 1), Fraction(0), ONE)
    assert largest_ratio([ONE] * 3, below, (3,), most=2000).above is None
    found = largest_ratio([ONE] * 3, below, (3,), limit=Fraction(100))
    assert found.above is None
    assert found.below > 100


def test_what_is_not_shown_in_time_is_not_claimed():
    """With no work, the coefficients of the whole box are all there is: 1/2 for 1/4."""
    found = largest_ratio(fractions(0, "1/2", 0), [ONE] * 3, (3,), most=-1)
    assert (found.above, found.below) == (Fraction(1, 2), 0)


def test_a_limit_between_the_bounds_draws_them_closer():
    limit = Fraction("0.250001")
    assert largest_ratio(fractions(0, "1/2", 0), [ONE] * 3, (3,), limit=limit).above <= limit


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
def test_no_point_is_above_and_the_witness_is_exact(data):
    shape = (3, data.draw(st.integers(2, 4)))
    size = shape[0] * shape[1]
    above, below = (
        [Fraction(n) for n in data.draw(st.lists(st.integers(1, 30), min_size=size, max_size=size))]
        for _ in range(2)
    )
    found = largest_ratio(above, below, shape)
    assert found.above <= found.below * (1 + NEARLY)
    for point in np.random.default_rng(1).uniform(size=(50, 2)):
        assert value(above, shape, point) <= float(found.above) * value(below, shape, point) + 1e-9
    at = [float(u) for u in found.at]
    ratio = value(above, shape, at) / value(below, shape, at)
    assert ratio == pytest.approx(float(found.below), rel=1e-9)
