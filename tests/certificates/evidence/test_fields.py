"""Numbers in certificate files: nothing but exact integers and ratios gets in."""

from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.certificates.evidence.fields import (
    matrix_fields,
    rate_text,
    read_integer,
    read_integers,
    read_matrix,
    read_ratio,
    read_text,
)
from nrs_design.certificates.exact import MAX_WORK
from nrs_design.switched.system import Time

WHOLE = st.integers(-(2**70), 2**70)


@given(
    st.lists(st.lists(WHOLE, min_size=3, max_size=3), min_size=3, max_size=3), st.integers(0, 99)
)
def test_matrix_survives_the_file(rows, power):
    Q = tuple(map(tuple, rows))
    assert read_matrix(matrix_fields(Q, power)) == (Q, power)


@pytest.mark.parametrize("value", [True, 1.0, "1", None, [1], Decimal(1), Fraction(1)])
def test_only_an_integer_is_an_integer(value):
    with pytest.raises(TypeError, match="expected an integer"):
        read_integer(value)
    with pytest.raises(TypeError, match="expected an integer"):
        read_integers([[1, 0], [0, value]])


def test_a_matrix_beyond_all_bounds_is_refused():
    with pytest.raises(ValueError, match="too large to check"):
        read_integers([[1 << MAX_WORK]])


@pytest.mark.parametrize("power", [-1, -(10**9)])
def test_a_denominator_is_a_power_of_two(power):
    with pytest.raises(ValueError, match="power of two"):
        read_matrix({"numerators": [[1]], "denominator_log2": power})


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
    assert Fraction(rate_text(rate, Time.CONTINUOUS)) <= rate
    assert Fraction(rate_text(rate, Time.DISCRETE)) >= rate
    assert abs(Fraction(rate_text(rate, Time.CONTINUOUS)) / rate - 1) < Fraction(1, 10**5)
