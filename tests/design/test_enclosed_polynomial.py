"""Polynomials between rational numbers hold every polynomial that they are made of."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.design.enclosed_polynomial import (
    add,
    in_tangent,
    multiply,
    negative,
    numbers,
    rounded_outwards,
)

fractions = st.fractions(-9, 9, max_denominator=50)
enclosed = st.tuples(fractions, fractions).map(lambda pair: tuple(sorted(pair)))
polynomials = st.lists(enclosed, min_size=1, max_size=4)


def at(P, x):
    return sum(c * x**k for k, c in enumerate(P))


def inside(P, enclosure):
    return all(low <= c <= high for c, (low, high) in zip(P, enclosure, strict=True))


@given(polynomials, polynomials, st.integers(0, 3), fractions)
def test_sums_and_products_hold_those_of_members(P, Q, picks, x):
    """Each end of a coefficient, and both together."""
    one, two = ([pair[(picks >> i) % 2] for pair in R] for i, R in enumerate((P, Q)))
    product = [Fraction(0)] * (len(one) + len(two) - 1)
    for i, a in enumerate(one):
        for j, b in enumerate(two):
            product[i + j] += a * b
    assert inside(product, multiply(P, Q))
    assert at(product, x) == at(one, x) * at(two, x)
    longer = [Fraction(0)] * max(len(one), len(two))
    for R in (one, two):
        for i, a in enumerate(R):
            longer[i] += a
    assert inside(longer, add(P, Q))
    assert inside([-a for a in one], [negative(a) for a in P])
    assert inside(one, rounded_outwards(P))


def test_shortened_goes_outwards():
    third, exact = Fraction(1, 3), Fraction(5, 2**40)
    ((low, high), (down, up), same, zero) = rounded_outwards(
        [(third, third), (-third, -third), (exact, exact), (Fraction(0), Fraction(0))]
    )
    assert low < third < high
    assert down < -third < up
    assert high - low < Fraction(1, 2**60)
    assert same == (exact, exact)
    assert zero == (0, 0)


@pytest.mark.parametrize("degree", [2, 3])
def test_in_tangent(degree):
    P, w = numbers(3, -1, 2), Fraction(1, 7)
    z = (1 + w) / (1 - w)
    found = at([low for low, _ in in_tangent(P, degree)], w)
    assert found == (1 - w) ** degree * (3 - z + 2 * z**2)
