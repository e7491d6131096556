import dataclasses
import math
from fractions import Fraction
from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.spec import Quantity, kinds
from nrs_design.spec.exact import parse_exact
from nrs_design.spec.quantity import QuantityKind, is_less, parse_quantity
from nrs_design.spec.units import parse_unit

from .samples import message_of


def test_keeps_what_was_written() -> None:
    quantity = parse_quantity("4.8417e-4 rad/s/rpm", kinds.ACTUATOR_GAIN)
    assert quantity.text == "4.8417e-4 rad/s/rpm"
    assert quantity.unit == "rad/s/rpm"
    assert quantity.value == quantity.exact == Fraction(48417, 10**8)
    assert quantity.is_exact
    with pytest.raises(dataclasses.FrozenInstanceError):
        quantity.__setattr__("unit", "m")


def test_exact_is_refused_where_pi_enters() -> None:
    quantity = parse_quantity("8 deg/s", kinds.ANGULAR_VELOCITY)
    assert not quantity.is_exact
    assert quantity.si == pytest.approx(8 * math.pi / 180, rel=1e-15)
    with pytest.raises(ValueError, match="pi"):
        _ = quantity.exact


ALL_KINDS = [kind for kind in vars(kinds).values() if isinstance(kind, QuantityKind)]


numbers = st.fractions(min_value=Fraction(1, 10**6), max_value=10**6, max_denominator=10**6)


@given(numbers, numbers)
def test_order_does_not_depend_on_units(a: Fraction, b: Fraction) -> None:
    newton = Quantity(f"{a} N/m", a, "N/m")
    millimeter = Quantity(f"{b / 1000} N/mm", b / 1000, "N/mm")
    assert is_less(newton, millimeter) == (a < b)


@given(
    st.text(max_size=120) | st.text("mskgradN*/^()1-29 ", max_size=80), st.sampled_from(ALL_KINDS)
)
def test_garbage_is_read_or_refused(text: str, kind: QuantityKind) -> None:
    """As a number, a unit or a quantity."""
    for read in (parse_exact, parse_unit, partial(parse_quantity, kind=kind)):
        assert message_of(partial(read, text)).isprintable()
