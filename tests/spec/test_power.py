"""Powers with rational exponents."""

from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.spec.preload import DIGITS, power_between

F = Fraction
bases = st.fractions("1/1000", 1000, max_denominator=1000)
exponents = st.fractions(-3, 3, max_denominator=1000)


@pytest.mark.parametrize(
    ("base", "exponent", "power"),
    [
        (F(4), F(1, 2), F(2)),
        (F(8, 27), F(-2, 3), F(9, 4)),
        (F(7), F(0), F(1)),
        (F(1), F("0.2"), F(1)),
    ],
)
def test_powers_that_end_are_exact(base, exponent, power):
    assert power_between(base, exponent) == (power, power)


@settings(max_examples=50)
@given(bases, exponents)
def test_surely_between_and_near(base, exponent):
    low, high = power_between(base, exponent)
    q, power = exponent.denominator, base**exponent.numerator
    assert low**q <= power <= high**q
    assert low <= high <= low * (1 + F(1, 10 ** (DIGITS - 1)))


@pytest.mark.parametrize("base", [F(0), F(-2)])
def test_no_other_base(base):
    with pytest.raises(ValueError, match="no power"):
        power_between(base, F(1, 2))
