"""Numbers of claims as text: exact, or on the side that stays true and marked so."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.bounds import (
    at_least,
    at_most,
    lower,
    lower_float,
    nearly,
    rounded_down,
    rounded_up,
    upper,
    upper_float,
)
from tests.support import number_in

NUMBERS = st.fractions(min_value=0) | st.floats(0, 1e300).map(Fraction)


@given(NUMBERS)
def test_text_is_on_its_side(number):
    assert number_in(lower(number)) <= number <= number_in(upper(number))


@given(NUMBERS.filter(bool))
def test_text_is_near(number):
    assert number - number_in(lower(number)) <= number / 10**5
    assert number_in(upper(number)) - number <= number / 10**5


@given(NUMBERS)
def test_a_number_without_a_mark_is_exact(number):
    for mark, text in ((">=", at_least(number)), ("<=", at_most(number))):
        sign, digits = text.split(" ", 1)
        assert (number_in(digits) == number) if sign == "=" else sign == mark
    for text in (rounded_down(number), rounded_up(number)):
        assert "(rounded" in text or Fraction(text) == number
    assert nearly(number).startswith("about ") or Fraction(nearly(number)) == number


@pytest.mark.parametrize(
    ("number", "down", "up"),
    [
        ("42.60546875", "42.60546875 s", "42.60546875 s"),
        ("1000.00000049", "1000.00000049 s", "1000.00000049 s"),
        ("1000.0000000000049", "1000.00 s (rounded down)", "1000.01 s (rounded up)"),
        ("1/3", "0.333333 s (rounded down)", "0.333334 s (rounded up)"),
        # As long as is allowed, and one digit more.
        ("1000.000000049", "1000.000000049 s", "1000.000000049 s"),
        ("1000.0000000049", "1000.00 s (rounded down)", "1000.01 s (rounded up)"),
        ("1e-21", "1e-21 s", "1e-21 s"),
        ("0", "0 s", "0 s"),
    ],
)
def test_words(number, down, up):
    assert rounded_down(Fraction(number), "s") == down
    assert rounded_up(Fraction(number), "s") == up


@pytest.mark.parametrize(
    ("number", "text"),
    [
        (1 - Fraction(1, 10**30), "1 - 1e-30"),
        (1 - Fraction(1, 3 * 10**30), "1 - 3.33333e-31"),
        (Fraction(1), "1"),
        (1 + Fraction(1, 10**30), "1.00001"),
        (2 - Fraction(1, 10**30), "2.00000"),
        (-Fraction(1, 10**30), "-1e-30"),
    ],
)
def test_what_is_a_little_below_one_stays_below_it(number, text):
    """A contraction that is rounded up to 1 would be none."""
    assert upper(number) == text


def test_only_what_is_rounded_is_about():
    assert nearly(Fraction(5, 2), "s") == "2.5 s"
    assert nearly(Fraction(1, 3), "s") == "about 0.333333 s"


@given(st.fractions())
def test_doubles_are_on_their_side(number):
    assert lower_float(number) <= number <= upper_float(number)
    assert float(number) in (lower_float(number), upper_float(number))


def test_doubles_beyond_their_range():
    huge = Fraction(10**400)
    assert upper_float(huge) == float("inf")
    assert lower_float(huge) == 1.7976931348623157e308
    assert upper_float(-huge) == -1.7976931348623157e308
