from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.proof.mode import Time
from nrs_design.search.rates import (
    BACK_OFFS,
    BITS,
    RATE_BITS,
    claims,
    digits,
    rate_at,
    round_form,
    round_rate,
    unscale,
)

CONTINUOUS, DISCRETE = Time.CONTINUOUS, Time.DISCRETE


@pytest.mark.parametrize(("time", "limit"), [(CONTINUOUS, 3.7), (DISCRETE, 0.3)])
def test_claims_are_below_the_position_the_fastest_first(time, limit):
    proposed = list(claims(0.8, limit, time))
    assert len(proposed) == len(BACK_OFFS)
    assert proposed == sorted(proposed, reverse=time is CONTINUOUS)
    for back_off, claim in zip(BACK_OFFS, proposed, strict=True):
        rate = rate_at(0.8 * back_off, limit, time)
        assert claim == round_rate(rate, time)
        assert float(claim) == pytest.approx(rate, rel=1e-4)


def test_few_claims_and_few_digits_where_checks_take_long():
    assert [float(c) for c in claims(1.0, 1.0, CONTINUOUS, 0.9, few=True)] == pytest.approx(
        [0.9, 0.5, 0.1], rel=1e-4
    )
    assert digits(10)[:2] == (10, 12)
    assert digits() == BITS


@pytest.mark.parametrize(
    ("position", "limit", "time"),
    [
        (1.0, np.nan, CONTINUOUS),
        (1.0, np.inf, CONTINUOUS),
        (1.0, -1.0, CONTINUOUS),
        (0.0, 1.0, CONTINUOUS),
        (0.0, 0.5, DISCRETE),
        (1.0, 1.5, DISCRETE),
        (1.0, np.nan, DISCRETE),
    ],
)
def test_what_is_no_decay_is_not_claimed(position, limit, time):
    assert list(claims(position, limit, time)) == []


@pytest.mark.parametrize("exponents", [(0, 3), (5, -5), (-40, 17)])
def test_scaling_is_undone_exactly(exponents):
    Q, bits = np.array([[0.75, -0.5], [-0.5, 3.0]]), 4
    rows, denominator_log2 = unscale(Q, np.array(exponents), bits)
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            wanted = Fraction(Q[i, j]) / Fraction(2) ** (exponents[i] + exponents[j])
            assert Fraction(entry) / Fraction(2) ** denominator_log2 == wanted


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e308])
def test_a_form_beyond_floating_point_is_refused(value):
    with pytest.raises(OverflowError), np.errstate(all="ignore"):
        round_form(np.array([[value]]), np.array([0]), 20)


@given(st.floats(1e-300, 1e300))
def test_rates_in_continuous_time_only_get_slower(rate):
    rounded = round_rate(rate, Time.CONTINUOUS)
    assert 0 < rounded <= Fraction(rate)
    assert rounded >= Fraction(rate) * (1 - Fraction(1, 2 ** (RATE_BITS - 1)))
    assert rounded.denominator & (rounded.denominator - 1) == 0


@given(st.floats(0, 1, exclude_max=True))
def test_rates_in_discrete_time_only_get_slower(rate):
    assert Fraction(rate) <= round_rate(rate, Time.DISCRETE) < 1


@given(st.integers(20, 1900))
def test_rates_beyond_floating_point(digits):
    tiny = Fraction(1, 10**digits)
    rounded = round_rate(tiny, Time.CONTINUOUS)
    assert tiny * (1 - Fraction(1, 2 ** (RATE_BITS - 1))) <= rounded <= tiny
    assert round_rate(1 - tiny, Time.DISCRETE) == 1 - rounded
