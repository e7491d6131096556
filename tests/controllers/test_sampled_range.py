"""Coefficients of a sampled admittance whose gains are anywhere in a box."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from nrs_design.controllers.sampled_range import coefficient_ranges

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import Admittance
from nrs_design.errors import DesignError
from nrs_design.spec.interval import Interval

LAW = Admittance(Fraction(1), Fraction(1))
PERIOD = Fraction(1, 500)
SHARES = st.fractions(0, 1, max_denominator=1000)


def between(low: Fraction, high: Fraction) -> Interval:
    return Interval(low, low, high)


def box(Mt, Bt):
    return {"Mt": between(*map(Fraction, Mt)), "Bt": between(*map(Fraction, Bt))}


@given(
    low=st.tuples(
        st.fractions("0.001", 1, max_denominator=10**4),
        st.fractions("0.1", 20, max_denominator=100),
    ),
    wide=st.tuples(SHARES, SHARES),
    at=st.tuples(SHARES, SHARES),
    method=st.sampled_from(["exact", "euler"]),
)
def test_every_gain_in_the_box_has_its_coefficients_in_the_ranges(low, wide, at, method):
    """Gains of single precision, as a robot holds them; also where Euler's method overshoots."""
    Mt, Bt = (between(v, v * (1 + w)) for v, w in zip(low, wide, strict=True))
    found = coefficient_ranges(LAW, {"Mt": Mt, "Bt": Bt}, PERIOD, method)
    gains = [i.low + share * (i.high - i.low) for i, share in zip((Mt, Bt), at, strict=True)]
    held = [min(max(to_float32(v), i.low), i.high) for v, i in zip(gains, (Mt, Bt), strict=True)]
    law = Admittance(*held).sampled(PERIOD, method)
    if not found:
        assert Mt.low == Mt.high
        assert Bt.low == Bt.high
        return
    assert found["a"].low <= law.a <= found["a"].high
    assert found["c"].low <= law.b / (1 - law.a) <= found["c"].high
    # And it is no wider than single precision needs.
    share = Fraction(1, 2**20) * max(1, -found["a"].low) / (1 - found["a"].high)
    assert found["c"].high <= (1 + share) / Bt.low


def test_without_inertia_there_is_b_alone():
    found = coefficient_ranges(LAW, box((0, 0), (1, 4)), PERIOD, "exact")
    assert found == {"c": between(Fraction(1, 4), Fraction(1))}


def test_a_point_has_no_ranges():
    assert coefficient_ranges(LAW, box((1, 1), (2, 2)), PERIOD, "exact") == {}


@pytest.mark.parametrize(("Mt", "Bt"), [((1, 10**7), (1, 1)), ((1, 1), ("1e38", "2e38"))])
def test_a_coefficient_that_single_precision_loses_is_refused(Mt, Bt):
    with pytest.raises(DesignError, match="loses a coefficient") as caught:
        coefficient_ranges(LAW, box(Mt, Bt), PERIOD, "exact")
    assert "narrow the ranges" in caught.value.remedy
