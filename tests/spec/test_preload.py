"""A Hunt-Crossley law in a spec: the box of springs and dampers over its preload."""

import math
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nrs_design.models.contact import HuntCrossley
from nrs_design.models.interval import Interval
from nrs_design.spec.build_plant import build_plant
from nrs_design.spec.environment import HuntCrossleySpec
from nrs_design.spec.preload import DIGITS, ExponentSpec, power_between, power_box
from tests.tables import spec_text

from .samples import IMPEDANCE, interaction, spoiled

F = Fraction
LAW = spec_text("hunt-crossley")
LINEAR = "model: elastic\n    stiffness: 747.1461 N/m\n"
TEXT = spoiled(IMPEDANCE, LINEAR, LAW)


def test_box_of_an_exact_power():
    """phi = 1.5, from a quarter of `about` to four times it: all powers are rational."""
    exponent = ExponentSpec(nominal=F("1.5"))
    k, b = power_box(Interval.point(F(6)), Interval.point(F(1)), exponent, (F(1, 4), F(4)))
    # Chord 6/1.5 (1/4)^0.5 = 2, tangent 6 4^0.5 = 12; damping (1/4)^1.5 and 4^1.5.
    assert k == Interval(F(6), F(2), F(12))
    assert b == Interval(F(1), F(1, 8), F(8))


shares = st.floats(0, 1)


@given(
    phi=st.tuples(shares, shares),
    reach=st.tuples(st.floats(0.05, 1), st.floats(1, 6)),
    at=st.tuples(shares, shares, shares, shares, shares),
    speed=st.floats(-5, 5),
)
def test_force_about_any_rest_is_one_of_the_box(phi, reach, at, speed):
    """Any law of the ranges, any rest from the surface to the end, any deflection between."""
    ends = sorted(round(1 + share, 3) for share in phi)
    exponent = ExponentSpec(nominal=F(str(ends[0])), range=(F(str(ends[0])), F(str(ends[1]))))
    k0, b0 = Interval(F(5), F(4), F(6)), Interval(F(1), F(1, 2), F(2))
    low, high = (F(round(end, 6)).limit_denominator(10**6) for end in reach)
    k, b = power_box(k0, b0, exponent, (low, high))
    power = ends[0] + at[0] * (ends[1] - ends[0])
    stiffness, damping = 4 + 2 * at[1], 0.5 + 1.5 * at[2]
    # rho and lam of the law with this tangent at the deflection 1.
    law = HuntCrossley(stiffness / power, damping, power)
    delta = float(low) + at[3] * float(high - low)
    rest = at[4] * float(high)
    chord = law.tangent(delta)[0]
    if not math.isclose(delta, rest, rel_tol=1e-6):
        chord = law.rho * (delta**power - rest**power) / (delta - rest)
    near = 1e-7
    assert float(k.low) * (1 - near) <= chord <= float(k.high) * (1 + near)
    assert float(b.low) * (1 - near) <= law.lam * delta**power <= float(b.high) * (1 + near)
    force = law.rho * delta**power + law.lam * delta**power * speed
    linear = chord * (delta - rest) + law.lam * delta**power * speed
    assert force - law.rho * rest**power == pytest.approx(linear, rel=1e-6, abs=1e-5)


def test_spec():
    spec = interaction(TEXT)
    soft = spec.environments["soft"]
    assert isinstance(soft, HuntCrossleySpec)
    assert not soft.fixed
    assert not soft.is_spring
    environment = build_plant(spec).environment("soft")
    assert environment.law.name == "kelvin-voigt"
    assert environment.preloaded
    arm = F("0.0576")
    assert environment.stiffness.nominal == 750 * arm
    # 700/1.3 0.5^0.3 and 800 2^0.3 at the contact point.
    assert float(environment.stiffness.low / arm) == pytest.approx(437.367, abs=1e-3)
    assert float(environment.stiffness.high / arm) == pytest.approx(984.915, abs=1e-3)
    assert float(environment.parameters["b"].low / arm) == pytest.approx(10 * 0.5**1.3)
    assert float(environment.parameters["b"].high / arm) == pytest.approx(10 * 2**1.3)


bases = st.fractions("1/1000", 1000, max_denominator=1000)
exponents = st.fractions(-3, 3, max_denominator=1000)


@pytest.mark.parametrize("row", ["4 1/2 2", "8/27 -2/3 9/4", "7 0 1", "1 1/5 1"])
def test_powers_that_end_are_exact(row):
    base, exponent, power = map(F, row.split())
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
