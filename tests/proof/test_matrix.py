from fractions import Fraction
from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof import matrix
from tests.tables import by_rows

ROWS = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(st.fractions(), min_size=n, max_size=n), min_size=n, max_size=n)
)


@by_rows("numerators", "denominator")
def test_what_is_no_matrix(numerators, denominator):
    """A denominator that is not positive would turn or hide every sign."""
    assert not matrix.RationalMatrix(numerators, denominator).is_well_formed


@given(ROWS)
def test_nothing_is_lost(rows):
    A = matrix.RationalMatrix.from_rows(rows)
    assert A.denominator > 0
    assert A.fractions() == rows
    assert A.floats() == [[float(entry) for entry in row] for row in rows]


@given(ROWS)
def test_product_with_the_identity(rows):
    identity = [[int(i == j) for j in range(len(rows))] for i in range(len(rows))]
    assert matrix.multiply(rows, identity) == rows == matrix.multiply(identity, rows)


def test_integers_of_numpy_become_those_of_python():
    """They overflow without a word: 2^62 times 4 is 0 to NumPy."""
    A = matrix.RationalMatrix.from_rows(np.array([[2**62, 1], [-3, 0]]))
    assert matrix.RationalMatrix(((2**62, 1), (-3, 0))) == A
    B = matrix.RationalMatrix.from_rows([[Fraction(np.int64(1), np.int64(3)), np.int8(100)]])
    assert matrix.RationalMatrix(((1, 300),), 3) == B
    direct = matrix.RationalMatrix(((np.int64(2**62),),), np.int64(4))
    for M in (A, B, direct):
        assert {type(entry) for row in M.numerators for entry in row} == {int}
        assert type(M.denominator) is int


@pytest.mark.parametrize("entry", [0.5, Fraction(1, 2), "1", None])
def test_numerators_are_integers(entry):
    with pytest.raises(TypeError):
        matrix.RationalMatrix(((entry,),))


@pytest.mark.parametrize("entry", [float("nan"), float("inf"), None, np.float32(0.5), 1j])
def test_entries_are_finite_numbers(entry):
    with pytest.raises((TypeError, ValueError, OverflowError)):
        matrix.RationalMatrix.from_rows([[entry]])


def test_all_but_the_last():
    assert matrix.leading([[1, 2, 3], [4, 5, 6], [7, 8, 9]]) == [(1, 2), (4, 5)]


def test_crossing_with_a_unit_vector():
    M = [[0, 0, 0], [0, 10, 0], [0, 0, 0]]
    assert matrix.with_crossing(M, 1, [1, 2, 3]) == [[0, 1, 0], [1, 14, 3], [0, 3, 0]]
    assert M[1] == [0, 10, 0]


@pytest.mark.parametrize(
    ("left", "right"), [([[1, 2]], [[1]]), ([[1]], [[1], [2]]), ([[1, 2]], [[1, 2], [3]])]
)
def test_shapes_that_do_not_fit(left, right):
    with pytest.raises(ValueError, match="zip"):
        matrix.multiply(left, right)


def test_entries_beyond_floating_point():
    A = matrix.RationalMatrix(((10**400, -(10**400)), (1, 10**300)), 1)
    assert A.floats() == [[inf, -inf], [1.0, 1e300]]
    tiny = matrix.RationalMatrix(((1, 10**200),), 10**400)
    assert tiny.floats() == [[0.0, 1e-200]]


def test_the_identity():
    assert matrix.identity(2) == matrix.RationalMatrix(((1, 0), (0, 1)))


def test_a_bordered_matrix():
    form = matrix.bordered([[1, 2], [2, 3]], [Fraction(1, 2), 4], Fraction(5))
    assert form.fractions() == [[1, 2, Fraction(1, 2)], [2, 3, 4], [Fraction(1, 2), 4, 5]]
    with pytest.raises(ValueError, match="zip"):
        matrix.bordered([[1, 2], [2, 3]], [Fraction(1)], Fraction(5))
