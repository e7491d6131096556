from decimal import Decimal
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.errors import SpecError
from nrs_design.spec.exact import parse_exact
from tests.support import ends_soon
from tests.tables import rows


@pytest.mark.parametrize(("text", "value"), rows(__file__, "test_reads_exactly"))
def test_reads_exactly(text: str, value: str) -> None:
    assert parse_exact(text) == Fraction(value)


@pytest.mark.parametrize(
    "text", ["1e3000000000", "1e-3000000000", "1e101", "1e-101", "9" * 101, "1e" + "9" * 98]
)
def test_refuses_huge_numbers_at_once(text: str) -> None:
    with ends_soon(), pytest.raises(SpecError):
        parse_exact(text)


@given(st.decimals(allow_nan=False, allow_infinity=False, min_value=-(10**30), max_value=10**30))
def test_decimals_survive_the_round_trip(number: Decimal) -> None:
    text = str(number)
    if len(text) <= 100 and abs(number.adjusted()) < 50 and (number or "E" not in text):
        assert parse_exact(text) == Fraction(number)


@given(st.fractions())
def test_ratios_survive_the_round_trip(number: Fraction) -> None:
    text = str(number)
    if len(text) <= 100:
        assert parse_exact(text) == number
