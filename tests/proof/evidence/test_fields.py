"""Numbers in certificate files: nothing but exact integers and ratios gets in."""

import json
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.evidence import BlockTriangular
from nrs_design.proof.evidence.fields import (
    find_unreadable,
    rate_text,
    rate_words,
    read_integer,
    read_integers,
    read_ratio,
    read_text,
)
from nrs_design.proof.exact import MAX_WORK
from nrs_design.proof.mode import Time
from tests.proof.graphs import common_quadratic
from tests.support import number_in


@pytest.mark.parametrize("value", [True, 1.0, "1", None, [1], Decimal(1), Fraction(1)])
def test_only_an_integer_is_an_integer(value):
    with pytest.raises(TypeError, match="expected an integer"):
        read_integer(value)
    with pytest.raises(TypeError, match="expected an integer"):
        read_integers([[1, 0], [0, value]])


def test_a_matrix_beyond_all_bounds_is_refused():
    with pytest.raises(ValueError, match="too large to check"):
        read_integers([[1 << MAX_WORK]])


def test_only_a_text_is_a_text():
    assert read_text("m0") == "m0"
    with pytest.raises(TypeError, match="expected a text"):
        read_text(b"m0")


@given(st.fractions(min_value=0))
def test_ratio_survives_the_file(ratio):
    assert read_ratio(str(ratio)) == ratio


@pytest.mark.parametrize(
    "text", ["-1/2", "0.5", "1e3", "inf", "nan", "1/-2", " 1", "1/2/3", "1_0", "", "\u0661"]
)
def test_anything_else_is_no_ratio(text):
    with pytest.raises(ValueError, match="not a ratio"):
        read_ratio(text)


def test_a_ratio_over_zero_is_no_number():
    with pytest.raises(ZeroDivisionError):
        read_ratio("1/0")


@given(st.fractions(min_value="1/1000000", max_value=10**6))
def test_a_printed_rate_never_promises_more_than_the_proof(rate):
    # Decay of a continuous system is faster the larger alpha is, of a discrete one the smaller rho.
    slower, larger = (number_in(rate_text(rate, time)) for time in Time)
    assert slower <= rate <= larger
    assert abs(slower / rate - 1) < Fraction(1, 10**5)


@pytest.mark.parametrize(
    ("rate", "continuous", "discrete"),
    [
        (Fraction(1, 2), "alpha = 0.5 1/s", "rho = 0.5"),
        (Fraction("42.60546875"), "alpha = 42.60546875 1/s", "rho = 42.60546875"),
        (Fraction(2, 3), "alpha >= 0.666666 1/s", "rho <= 0.666667"),
        (1 - Fraction(1, 3 * 10**21), "alpha >= 0.999999 1/s", "rho <= 1 - 3.33333e-22"),
    ],
)
def test_words_of_a_rate_say_whether_it_is_rounded(rate, continuous, discrete):
    assert rate_words(rate, Time.CONTINUOUS) == continuous
    assert rate_words(rate, Time.DISCRETE) == discrete


LONG = Fraction(1, 10**2000)
# What `find_unreadable` lets pass at the most, in bits and in entries.
INTEGER, RATIO, ENTRIES = 14_000, 6_640, 100_000


@pytest.mark.parametrize(
    ("value", "is_readable"),
    [
        (2**INTEGER - 1, True),
        (1 - 2**INTEGER, True),
        (2**INTEGER, False),
        (-(2**INTEGER), False),
        (Fraction(2**RATIO - 1), True),
        (Fraction(2**RATIO), False),
        (Fraction(1, 2**RATIO - 1), True),
        (Fraction(1, 2**RATIO), False),
        ((None,) * ENTRIES, True),
        ((None,) * (ENTRIES + 1), False),
        ([1, [2]], True),
        ([1, [2.0]], False),
        ((2.0, 1), False),
    ],
    ids=lambda value: type(value).__name__,
)
def test_what_is_just_readable(value, is_readable):
    assert (find_unreadable(value) is None) is is_readable


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (10**4300, "14285 bits"),
        (((1, 2), (3, -(10**4300))), "14285 bits"),
        (LONG, "more than 6640"),
        ((("m0", LONG),), "more than 6640"),
        (np.int64(3), "type int64"),
        (((1, np.int64(2)),), "type int64"),
        (0.5, "type float"),
        (True, "type bool"),
        (common_quadratic(((np.int8(1),),), 0, Fraction(1, 2)), "type int8"),
        (BlockTriangular(((0,),), ((0, common_quadratic(((1.0,),), 0, LONG)),)), "type float"),
        (((),) * 100_001, "100001 entries"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_numbers_that_no_file_can_hold(value, said):
    assert said in find_unreadable(value)


@given(
    st.integers(-(10**4000), 10**4000),
    st.builds(Fraction, st.integers(0, 10**1900), st.integers(1, 10**1900)),
)
def test_numbers_that_a_file_can_hold(number, ratio):
    assert find_unreadable((number, ("m0", ratio), None)) is None
    assert read_integer(json.loads(json.dumps(number))) == number
    assert read_ratio(str(ratio)) == ratio
