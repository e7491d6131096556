import struct
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.float32 import (
    exact_decimal,
    float32_not_above,
    float32_not_below,
    is_float32,
    neighbors,
    round_float32,
    round_significant,
)
from nrs_design.errors import DesignError
from tests.tables import rows

LARGEST = (2 - Fraction(1, 2**23)) * 2**127


@pytest.mark.parametrize(("value", "rounded"), rows(__file__, "test_known_numbers"))
def test_known_numbers(value, rounded):
    assert round_float32(Fraction(value)) == Fraction(rounded)
    assert exact_decimal(round_float32(Fraction(value))) == rounded


@given(st.floats(width=64, allow_nan=False, min_value=-3e38, max_value=3e38))
def test_agrees_with_the_hardware(value):
    assert round_float32(Fraction(value)) == Fraction(float(np.float32(value)))


def test_rounded_once():
    """By way of a double, 1 + 2^-24 + 2^-60 would become 1 + 2^-24, a tie, and then 1."""
    value = 1 + Fraction(1, 2**24) + Fraction(1, 2**60)
    assert round_float32(value) == 1 + Fraction(1, 2**23)


@given(st.binary(min_size=4, max_size=4))
def test_every_single_precision_number_is_one(pattern):
    (value,) = struct.unpack("<f", pattern)
    if np.isfinite(value):
        exact = Fraction(value)
        assert is_float32(exact)
        assert round_float32(exact) == exact
        assert Fraction(exact_decimal(exact)) == exact


@given(st.fractions(max_denominator=10**12))
def test_nearest(value):
    if abs(value) > LARGEST:
        return
    rounded = round_float32(value)
    step = abs(rounded) * Fraction(1, 2**23) + Fraction(1, 2**149)
    assert abs(rounded - value) <= step / 2
    assert is_float32(rounded)


@pytest.mark.parametrize("exponent", [-149, -150, -200, -5000])
def test_smallest_numbers(exponent):
    value = Fraction(2) ** exponent
    assert round_float32(value) == (value if exponent == -149 else 0)
    assert round_float32(-3 * Fraction(2) ** -150) == -(Fraction(2) ** -148)


def test_beyond_the_range():
    assert round_float32(LARGEST) == LARGEST
    for value in (Fraction(2) ** 128, -(Fraction(2) ** 128), Fraction(10) ** 5000):
        assert not is_float32(value)
        with pytest.raises(DesignError, match="single precision"):
            round_float32(value)


@pytest.mark.parametrize("text", ["0.1", "2.15", "1/3", "16777217"])
def test_not_single_precision(text):
    assert not is_float32(Fraction(text))


def test_no_terminating_expansion():
    with pytest.raises(ValueError, match="1/3"):
        exact_decimal(Fraction(1, 3))


@pytest.mark.parametrize(("value", "digits", "rounded"), rows(__file__, "test_round_significant"))
def test_round_significant(value, digits, rounded):
    assert round_significant(value, digits) == Fraction(rounded)


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [(1.2345, 3, (1.2245, 1.2345, 1.2445)), (0.01, 3, (0.0099, 0.01, 0.0101)), (0.0, 3, (0, 0, 0))],
)
def test_neighbors_are_one_step_of_the_last_digit_away(value, digits, expected):
    assert neighbors(value, digits) == pytest.approx(expected)


@given(st.fractions(min_value=-4, max_value=4), st.integers(-160, 100))
def test_the_numbers_on_both_sides(share, exponent):
    """Single-precision numbers both, equal or next to each other, zero and negative ones too."""
    value = share * Fraction(2) ** exponent
    low, high = float32_not_above(value), float32_not_below(value)
    assert low <= value <= high
    assert is_float32(low)
    assert is_float32(high)
    if low == high:
        assert low == value
    else:
        assert np.nextafter(np.float32(float(low)), np.float32(np.inf)) == np.float32(float(high))
