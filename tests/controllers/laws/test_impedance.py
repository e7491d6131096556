"""The admittance as a processor runs it: its coefficients, and those of gains in a box."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import cont2discrete

from nrs_design.controllers.float32 import is_float32, to_float32
from nrs_design.controllers.laws import Admittance
from nrs_design.errors import DesignError
from nrs_design.models.interval import Interval

PERIOD = Fraction(1, 500)
LAW = Admittance(to_float32(Fraction("0.01")), to_float32(Fraction("2.15")))
SHARES = st.fractions(0, 1, max_denominator=1000)


@settings(deadline=None)
@given(st.floats(2**-10, 1, width=32), st.floats(0.125, 20, width=32), st.integers(1, 50))
def test_exact_steps_are_those_of_a_held_force(Mt, Bt, ms):
    period = Fraction(ms, 1000)
    held = Admittance(Fraction(Mt), Fraction(Bt)).discretize(period, "exact").numbers
    a, b, *_ = cont2discrete(
        (np.array([[-Bt / Mt]]), np.array([[1 / Mt]]), np.eye(1), np.zeros((1, 1))), float(period)
    )
    assert float(held["a"]) == pytest.approx(a.item(), rel=1e-6, abs=1e-12)
    assert float(held["b"]) == pytest.approx(b.item(), rel=1e-6)
    assert all(map(is_float32, held.values()))


def test_one_step_of_euler():
    held = LAW.discretize(PERIOD, "euler").numbers
    assert held["a"] == to_float32(1 - LAW.Bt * PERIOD / LAW.Mt)
    assert held["b"] == to_float32(PERIOD / LAW.Mt)


def test_without_inertia_the_law_has_no_memory():
    held = Admittance(Fraction(0), Fraction(2)).discretize(PERIOD, "exact").numbers
    assert held == {"b": Fraction(1, 2), "T": to_float32(PERIOD)}


def test_a_spring_is_a_coefficient_of_its_own():
    """Its force counts as force: the other coefficients are those of the law without it."""
    sprung = replace(LAW, Kt=Fraction(1, 2))
    for method in ("exact", "euler"):
        plain = LAW.discretize(PERIOD, method).numbers
        assert sprung.discretize(PERIOD, method).numbers == {**plain, "Kt": Fraction(1, 2)}


def between(low, high):
    return Interval(Fraction(low), Fraction(low), Fraction(high))


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
    found = LAW.enclose({"Mt": Mt, "Bt": Bt}, PERIOD, method)
    gains = [i.low + share * (i.high - i.low) for i, share in zip((Mt, Bt), at, strict=True)]
    held = [min(max(to_float32(v), i.low), i.high) for v, i in zip(gains, (Mt, Bt), strict=True)]
    law = Admittance(*held).discretize(PERIOD, method)
    if not found:
        assert (Mt.low, Bt.low) == (Mt.high, Bt.high)
        return
    a, b = law.numbers["a"], law.numbers["b"]
    assert found["a"].low <= a <= found["a"].high
    assert found["c"].low <= b / (1 - a) <= found["c"].high
    assert law.at({"a": a, "c": b / (1 - a)}) == law
    # And it is no wider than single precision needs.
    share = Fraction(1, 2**20) * max(1, -found["a"].low) / (1 - found["a"].high)
    assert found["c"].high <= (1 + share) / Bt.low


@pytest.mark.parametrize(
    ("Mt", "Bt", "found"),
    [((0, 0), (1, 4), {"c": between("0.25", 1)}), ((1, 1), (2, 2), {})],
)
def test_ranges_without_inertia_and_of_a_point(Mt, Bt, found):
    spring = {"Kt": between(1, 2)}
    gains = {"Mt": between(*Mt), "Bt": between(*Bt)}
    assert LAW.enclose(gains, PERIOD, "exact") == found
    assert LAW.enclose(gains | spring, PERIOD, "exact") == found | spring


@pytest.mark.parametrize(("Mt", "Bt"), [((1, 10**7), (1, 1)), ((1, 1), ("1e38", "2e38"))])
def test_a_coefficient_that_single_precision_loses_is_refused(Mt, Bt):
    with pytest.raises(DesignError, match="loses a coefficient") as caught:
        LAW.enclose({"Mt": between(*Mt), "Bt": between(*Bt)}, PERIOD, "exact")
    assert "narrow the ranges" in caught.value.remedy
