from fractions import Fraction
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.switched.matrix import RationalMatrix, multiply

ROWS = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(st.fractions(), min_size=n, max_size=n), min_size=n, max_size=n)
)


def test_least_common_denominator():
    A = RationalMatrix.from_rows([[Fraction(1, 6), Fraction("-0.25")], [2, 0]])
    assert RationalMatrix(((2, -3), (24, 0)), 12) == A
    assert A.shape == (2, 2)


@given(ROWS)
def test_nothing_is_lost(rows):
    A = RationalMatrix.from_rows(rows)
    assert A.denominator > 0
    assert A.fractions() == rows
    assert A.floats() == [[float(entry) for entry in row] for row in rows]


@given(ROWS)
def test_product_with_the_identity(rows):
    identity = [[int(i == j) for j in range(len(rows))] for i in range(len(rows))]
    assert multiply(rows, identity) == rows == multiply(identity, rows)


def test_known_product():
    half = Fraction(1, 2)
    assert multiply([[1, half]], [[2, 0], [0, 4]]) == [[2, 2]]


@pytest.mark.parametrize(("left", "right"), [([[1, 2]], [[1]]), ([[1]], [[1], [2]])])
def test_shapes_that_do_not_fit(left, right):
    with pytest.raises(ValueError, match="zip"):
        multiply(left, right)


def test_entries_beyond_floating_point():
    A = RationalMatrix(((10**400, -(10**400)), (1, 10**300)), 1)
    assert A.floats() == [[inf, -inf], [1.0, 1e300]]
    tiny = RationalMatrix(((1, 10**200),), 10**400)
    assert tiny.floats() == [[0.0, 1e-200]]
