from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.spec.units import ONE, UNITS, parse_unit
from tests.tables import rows


@pytest.mark.parametrize(("text", "factor", "power"), rows(__file__, "test_factors_are_exact"))
def test_factors_are_exact(text: str, factor: str, power: int) -> None:
    """A rational number times a power of pi."""
    assert (parse_unit(text).factor, parse_unit(text).pi_power) == (Fraction(factor), power)


@pytest.mark.parametrize(("a", "b", "same"), rows(__file__, "test_dimensions"))
def test_dimensions(a: str, b: str, same: bool) -> None:
    assert (parse_unit(a).dimension == parse_unit(b).dimension) is same


@given(st.sampled_from(sorted(UNITS)), st.sampled_from(sorted(UNITS)), st.integers(-3, 3))
def test_products_and_powers_are_homomorphic(a: str, b: str, power: int) -> None:
    expected = ONE.times(UNITS[a]).times(UNITS[b], power)
    assert parse_unit(f"{a}*{b}^{power}") == expected
    assert parse_unit(f"({a})/({b})^{-power}") == expected
    assert parse_unit(f"1/({a}*{b}^{power})") == ONE.times(expected, -1)
