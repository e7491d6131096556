"""Ranges that are stretched about their nominal values."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.gains import gains_of
from nrs_design.errors import AssemblyError
from nrs_design.loop.assemble import assemble_from_text
from nrs_design.models.interval import Interval
from nrs_design.pipeline.runs import run_design
from nrs_design.spec import LoadedSpec, parse_spec
from tests.support import words_of

BOX = parse_spec(
    "kind: switched-system\nname: s\ntime: continuous\nswitching: arbitrary\n"
    "parameters:\n  k: {nominal: 3, range: [1, 6]}\n"
    "  m: {nominal: 1, range: [0, 2], varies: false}\nmodes: [{name: a, A: [['-k - m']]}]\n"
)
TEXT = """\
kind: interaction-design
name: hand
actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}
motion_loop: {damping_ratio: 0.707, settling_time: 0.1404 s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments:
  hand:
    model: kelvin-voigt
    stiffness: {nominal: 50 N*m/rad, range: [25 N*m/rad, 90 N*m/rad]}
    damping: {nominal: 0.5 N*m*s/rad, range: [0.25 N*m*s/rad, 1 N*m*s/rad]}
  other: {model: elastic, stiffness: {nominal: 1 N*m/rad, range: [0.25 N*m/rad, 2 N*m/rad]}}
controllers:
  insertion: {type: impedance, environment: hand, Mt: 0.01 kg*m^2, Bt: 2.15 N*m*s/rad}
switching: arbitrary
"""
HAND = parse_spec(TEXT)
SCALES = st.fractions(0, 4, max_denominator=9)


@pytest.fixture(scope="module")
def gains():
    return gains_of(run_design(LoadedSpec(path="hand", sha256="", text=TEXT, spec=HAND)).design)


def names(system):
    return [mode.name for mode in system.modes]


@given(SCALES, st.lists(st.fractions(-50, 50, max_denominator=9), min_size=3, max_size=3))
def test_intervals_keep_their_nominal_value(scale, values):
    low, nominal, high = sorted(values)
    found = Interval(nominal, low, high).scaled(scale)
    assert found.nominal == nominal
    assert nominal - found.low == scale * (nominal - low)
    assert found.high - nominal == scale * (high - nominal)


def test_parameters_are_scaled():
    half = assemble_from_text(BOX, {}, Fraction(1, 2))
    assert names(half) == ["a/k-min/m-min", "a/k-min/m-max", "a/k-max/m-min", "a/k-max/m-max"]
    assert [mode.A.fractions()[0][0] for mode in half.modes] == [
        Fraction(-5, 2),
        Fraction(-7, 2),
        -5,
        -6,
    ]
    assert {
        "Parameter k stays in [2, 4.5] and may change arbitrarily fast.",
        "All ranges of the spec are scaled about their nominal values by 1/2.",
    } <= set(words_of(half))


def test_scale_one_is_what_the_spec_says():
    assert assemble_from_text(BOX, {}, Fraction(1)) == assemble_from_text(BOX, {})
    assert not any("scaled" in text for text in words_of(assemble_from_text(BOX, {})))


def test_scale_zero_leaves_the_nominal_values():
    nominal = assemble_from_text(BOX, {}, Fraction(0))
    assert names(nominal) == ["a"]
    assert nominal.modes[0].A.fractions() == [[-4]]
    assert nominal.switching.is_arbitrary
    assert "Parameter k is 3." in words_of(nominal)


def test_environments_are_scaled(gains):
    whole = assemble_from_text(HAND, gains)
    double = assemble_from_text(HAND, gains, Fraction(4, 3))
    nominal = assemble_from_text(HAND, gains, Fraction(0))
    ends = ["k-min/b-min", "k-min/b-max", "k-max/b-min", "k-max/b-max"]
    assert names(whole) == names(double) == [f"insertion/hand/{end}" for end in ends]
    assert names(nominal) == ["insertion/hand"]
    # The row of the admittance velocity holds k/Mt: nominal 50, ends 25 and 90.
    centre = nominal.modes[0].A.fractions()[2][3]
    for mode, wide in zip(whole.modes, double.modes, strict=True):
        assert wide.A.fractions()[2][3] - centre == Fraction(4, 3) * (
            mode.A.fractions()[2][3] - centre
        )
    assert words_of(double)[-1] == (
        "All ranges of the spec are scaled about their nominal values by 4/3."
    )


def test_stiffness_stays_positive(gains):
    assemble_from_text(HAND, gains, Fraction("1.99"))
    with pytest.raises(AssemblyError, match="environment hand reaches a stiffness"):
        assemble_from_text(HAND, gains, Fraction(2))


def test_negative_scales_are_refused():
    with pytest.raises(AssemblyError, match="cannot be scaled by -1"):
        assemble_from_text(BOX, {}, Fraction(-1))


def test_has_ranges():
    assert BOX.has_ranges
    assert HAND.has_ranges
    untouched = TEXT.replace("environment: hand,", "environment: other,")
    assert parse_spec(untouched).has_ranges
    fixed = untouched.replace("{nominal: 1 N*m/rad, range: [0.25 N*m/rad, 2 N*m/rad]}", "1 N*m/rad")
    assert not parse_spec(fixed).has_ranges
    assert not parse_spec(
        "kind: switched-system\nname: s\ntime: discrete\nswitching: arbitrary\n"
        "parameters: {k: {nominal: 3}}\nmodes: [{name: a, A: [[k]]}]\n"
    ).has_ranges
    assert not parse_spec(
        untouched[: untouched.index("environments:")]
        + "controllers: {free: {type: position}}\nswitching: arbitrary\n"
    ).has_ranges
