"""Exponentials by a Taylor series: against flint, and errors counted by hand."""

from fractions import Fraction
from math import ceil, factorial

import pytest
from flint import arb, fmpq
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.taylor import UNIT, exponential_between, exponential_nearly
from nrs_design.proof.enclosure import exponential, overlap, precision
from nrs_design.proof.matrix import RationalMatrix
from tests.tables import rows

DIGITS = Fraction(1, 10**60)


def e_to_the(x):
    """The series in fractions with more terms than needed, for ``|x| <= 10``."""
    return sum((Fraction(x) ** k / factorial(k) for k in range(150)), Fraction(0))


def test_no_time_leaves_everything_as_it_is():
    M, error = exponential_nearly(RationalMatrix(((5, -3), (2, 9))), Fraction(0))
    assert M.fractions() == [[1, 0], [0, 1]]
    # By hand: 2 n for the rounded exponent, 2 n for the steps, and one for the terms left out.
    assert error == Fraction(9, 2**256)


@pytest.mark.parametrize(("x", "units"), [("1/256", 12), ("1/128", 26), ("1e-30", 12)])
def test_small_exponents_are_squared_once_or_twice(x, units):
    """By hand: a square of about one doubles an error of 5 and rounds, to 11 and a bit."""
    _, error = exponential_nearly(RationalMatrix.from_rows([[Fraction(x)]]), Fraction(1))
    assert error == Fraction(units, 2**256)


def norm(M):
    return max(sum(map(abs, row)) for row in M)


@pytest.mark.parametrize(("rows", "time"), rows(__file__, "test_twice_the_time_is_one_more_square"))
def test_twice_the_time_is_one_more_square(rows, time):
    """The same exponent is halved once more: ``2 |E| e + e^2`` and n from rounding."""
    (once, error), (twice, more) = (
        exponential_nearly(RationalMatrix(rows), Fraction(t)) for t in (time, 2 * time)
    )
    E, n, units = once.fractions(), len(rows), error * UNIT
    assert more * UNIT == ceil(2 * norm(E) * units + units**2 / UNIT + n)
    for i, row in enumerate(twice.numerators):
        for j, entry in enumerate(row):
            square = sum(once.numerators[i][k] * once.numerators[k][j] for k in range(n))
            assert entry == square // UNIT


@pytest.mark.parametrize("rows", [((0, 0), (0, 10)), ((10, 0), (0, 0))])
def test_the_largest_row_decides_how_small_the_exponent_is_made(rows):
    M, error = exponential_nearly(RationalMatrix(rows), Fraction(1))
    assert error < DIGITS
    for i, row in enumerate(M.fractions()):
        assert abs(row[i] - e_to_the(rows[i][i])) <= error + Fraction(1, 10**80)


@given(
    st.integers(1, 4).flatmap(
        lambda n: st.lists(
            st.lists(st.integers(-99, 99), min_size=n, max_size=n), min_size=n, max_size=n
        )
    ),
    st.integers(1, 99),
    st.fractions(min_value=0, max_value=4),
)
def test_the_semigroup_property_and_flint(rows, denominator, time):
    """``exp(A t) = exp(A t/2)^2`` within the errors; and flint's balls are met, tightly."""
    A = RationalMatrix(tuple(map(tuple, rows)), denominator)
    (whole, error), (half, small) = (exponential_nearly(A, t) for t in (time, time / 2))
    n, H = len(rows), half.fractions()
    norm = max(sum(map(abs, row)) for row in H)
    for i, row in enumerate(whole.fractions()):
        for j, entry in enumerate(row):
            square = sum(H[i][k] * H[k][j] for k in range(n))
            assert abs(entry - square) <= error + 2 * norm * small + small**2
    with precision():
        assert overlap(exponential(A, time, time), whole, error)
        for sign in (-1, 1):
            moved = [
                [e + sign * (3 * error + DIGITS * norm**2) for e in r] for r in whole.fractions()
            ]
            assert not overlap(exponential(A, time, time), RationalMatrix.from_rows(moved), error)


@given(st.fractions(-50, 5, max_denominator=10**6))
def test_the_exponential_of_a_number_lies_between_its_bounds(x):
    """Flint's ball meets the bounds, which are two units of 2^-80 apart at most."""
    low, high = exponential_between(x)
    with precision():
        ball = arb(fmpq(x.numerator, x.denominator)).exp()
        assert arb(fmpq(low.numerator, low.denominator)) <= ball
        assert ball <= arb(fmpq(high.numerator, high.denominator))
    assert high - low <= Fraction(2, 2**80)


def test_the_exponential_of_zero_is_one():
    unit = Fraction(1, 2**80)
    assert exponential_between(Fraction(0)) == (1 - unit, 1 + unit)
