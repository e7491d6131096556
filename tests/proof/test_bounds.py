"""Numbers of claims as text: exact, or on the side that stays true and marked so."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof import bounds
from tests.support import number_in
from tests.tables import by_rows

NUMBERS = st.fractions(min_value=0) | st.floats(0, 1e300).map(Fraction)


@given(NUMBERS)
def test_text_is_on_its_side(number):
    assert number_in(bounds.lower(number)) <= number <= number_in(bounds.upper(number))


@given(NUMBERS.filter(bool))
def test_text_is_near(number):
    assert number - number_in(bounds.lower(number)) <= number / 10**5
    assert number_in(bounds.upper(number)) - number <= number / 10**5


@given(NUMBERS)
def test_a_number_without_a_mark_is_exact(number):
    for mark, text in ((">=", bounds.at_least(number)), ("<=", bounds.at_most(number))):
        sign, digits = text.split(" ", 1)
        assert (number_in(digits) == number) if sign == "=" else sign == mark
    for text in (bounds.rounded_down(number), bounds.rounded_up(number)):
        assert "(rounded" in text or Fraction(text) == number
    assert bounds.nearly(number).startswith("about ") or Fraction(bounds.nearly(number)) == number


@by_rows("number", "down", "up")
def test_words(number, down, up):
    assert bounds.rounded_down(Fraction(number), "s") == down
    assert bounds.rounded_up(Fraction(number), "s") == up


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
    assert bounds.upper(number) == text


def test_only_what_is_rounded_is_about():
    assert bounds.nearly(Fraction(5, 2), "s") == "2.5 s"
    assert bounds.nearly(Fraction(1, 3), "s") == "about 0.333333 s"


@given(st.fractions())
def test_doubles_are_on_their_side(number):
    assert bounds.lower_float(number) <= number <= bounds.upper_float(number)
    assert float(number) in (bounds.lower_float(number), bounds.upper_float(number))


def test_doubles_beyond_their_range():
    huge = Fraction(10**400)
    assert bounds.upper_float(huge) == float("inf")
    assert bounds.lower_float(huge) == 1.7976931348623157e308
    assert bounds.upper_float(-huge) == -1.7976931348623157e308
