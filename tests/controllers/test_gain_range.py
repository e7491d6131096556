"""Ranges of gains: what a robot holds in single precision must be inside."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.gain_range import faults_of_ranges, gain_interval
from nrs_design.errors import CertificateError, DesignError
from nrs_design.models.interval import Interval
from nrs_design.pipeline import run_design
from nrs_design.spec import LoadedSpec, Quantity, parse_spec
from nrs_design.spec.gain_fields import GainSpec
from nrs_design.switched.assemble import assemble_from_text

TEXT = """\
kind: interaction-design
name: hand
actuator: {gain: 4.8417e-4 rad/s/rpm, time_constant: 0.0351 s}
motion_loop: {damping_ratio: 0.707, settling_time: 0.1404 s}
limits: {velocity: 8 deg/s, torque: 0.3 N*m, bandwidth: 2 Hz}
environments: {soft: {model: elastic, stiffness: 43.0356 N*m/rad}}
controllers:
  insertion: {type: impedance, environment: soft, Mt: MASS, Bt: DAMPING}
switching: arbitrary
"""
numbers = st.fractions("1/100", 100, max_denominator=10**6)


def gain(low, nominal, high):
    quantities = [Quantity(f"{q} N*m*s/rad", q, "N*m*s/rad") for q in (nominal, low, high)]
    return GainSpec(nominal=quantities[0], range=tuple(quantities[1:]))


def loaded(mass, damping):
    text = TEXT.replace("MASS", mass).replace("DAMPING", damping)
    return LoadedSpec(path="hand", sha256="", text=text, spec=parse_spec(text))


@given(st.lists(numbers, min_size=4, max_size=4))
def test_whatever_is_set_on_the_robot_is_inside(values):
    low, nominal, set_later, high = sorted(values)
    interval = gain_interval(gain(low, nominal, high), to_float32(nominal))
    if low == high:
        assert interval == Interval.point(to_float32(nominal))
        return
    assert interval.low <= low <= set_later <= high <= interval.high
    assert interval.low <= to_float32(set_later) <= interval.high
    assert interval.low <= interval.nominal <= interval.high
    # Not wider than rounding to single precision asks for.
    assert interval.low in (low, to_float32(low))
    assert interval.high in (high, to_float32(high))


def test_a_gain_at_the_end_of_its_range_is_inside_after_rounding():
    # 0.01 in single precision is below 0.01.
    spec = loaded("{nominal: 0.01 kg*m^2, range: [0.01 kg*m^2, 0.02 kg*m^2]}", "2.15 N*m*s/rad")
    law = run_design(spec).design.controllers[0].law
    assert law.Mt < Fraction("0.01")
    given_gain = spec.spec.controllers["insertion"].Mt
    assert gain_interval(given_gain, law.Mt).low == law.Mt
    assert not list(faults_of_ranges(spec.spec.controllers["insertion"], {"Mt": law.Mt, "Bt": 2}))


def test_designed_gain_outside_its_range_is_an_error_that_names_both():
    damping = "{min: 0.1 N*m*s/rad, max: 20 N*m*s/rad, range: [3 N*m*s/rad, 4 N*m*s/rad]}"
    with pytest.raises(DesignError) as caught:
        run_design(loaded("0.01 kg*m^2", damping))
    assert "controller insertion: the designed Bt, 2.1" in caught.value.message
    assert "outside its range [3 N*m*s/rad, 4 N*m*s/rad]" in caught.value.message
    assert caught.value.remedy


def test_gains_of_a_certificate_outside_their_range_are_refused():
    damping = "{min: 1 N*m*s/rad, max: 4 N*m*s/rad, range: [2 N*m*s/rad, 3 N*m*s/rad]}"
    spec = loaded("0.5 kg*m^2", damping).spec
    # Kd and Kp may be anything positive here: the spec fixes neither.
    gains = {"motion": {"Kp": "8", "Kd": "1"}, "insertion": {"Mt": "0.5", "Bt": "2.5"}}
    assert len(assemble_from_text(spec, gains).modes) == 2
    for value in ("1.5", "3.5"):
        outside = gains | {"insertion": {"Mt": "0.5", "Bt": value}}
        with pytest.raises(CertificateError, match=f"the designed Bt, {value}, is outside"):
            assemble_from_text(spec, outside)
