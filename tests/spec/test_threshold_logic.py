"""Thresholds on command and torque: how far apart switches lie, and what is refused."""

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from nrs_design.spec import load_spec
from nrs_design.spec.threshold_logic import ThresholdLogicSpec, values_at_switch
from tests.support import ROOT

BY_SIGN = ROOT / "docs/examples/insertion-by-sign.nrs.yaml"
SIGNALS = {
    "command": {"noise": "0.1 deg/s", "age": "4 ms", "largest_rate": "40 deg/s^2"},
    "torque": {"noise": "0.002 N*m", "age": "4 ms", "largest_rate": "6.1 N*m/s"},
}
OUT = {"from": "in", "to": "out", "command": {"below": "-0.5 deg/s"}}
BACK = {"from": "out", "to": "in", "command": {"above": "0.5 deg/s"}}


def logic(*switches, **others):
    given = {"type": "thresholds", "start": "in", "signals": SIGNALS, "switches": list(switches)}
    return ThresholdLogicSpec.model_validate(given | others)


def test_the_time_between_switches_by_hand():
    """``(1 deg/s - 2 * 0.1 deg/s) / 40 deg/s^2 - 4 ms = 16 ms``: pi cancels."""
    found = logic(OUT, BACK)
    assert found.tightest("out").seconds == Fraction(16, 1000)
    assert found.stay("in").text == found.stay("out").text == "0.016 s"
    assert found.held_back("in") == 0


def test_the_tightest_pair_counts_and_is_rounded_down():
    spec = load_spec(BY_SIGN)
    apart = spec.mode_logic.tightest("withdrawal")
    assert apart.seconds == (Fraction("0.06") - Fraction("0.004")) / Fraction("6.1") - Fraction(
        "0.004"
    )
    assert (apart.entering, apart.leaving, apart.signal) == (0, 2, "torque")
    assert Fraction("0.00518") == spec.switching.stay("withdrawal")[0].value < apart.seconds


@given(*[st.integers(1, 10**6)] * 4)
def test_powers_of_pi_that_do_not_cancel_make_it_shorter(high, low, noise, rate):
    """Thresholds in rad/s beside a rate in deg/s^2; against 30 digits of pi."""
    command = {"noise": f"{noise}e-6 deg/s", "age": "1 ms", "largest_rate": f"{rate}e-3 deg/s^2"}
    there = OUT | {"command": {"below": f"-{low}e-5 rad/s"}}
    back = BACK | {"command": {"above": f"{high}e-5 rad/s"}}
    found = logic(there, back, signals={"command": command}, hold="1 s")
    pi = Fraction("3.14159265358979323846264338328")
    degree = pi / 180
    band = Fraction(high + low, 10**5) - 2 * Fraction(noise, 10**6) * degree
    exact = band / (Fraction(rate, 1000) * degree) - Fraction(1, 1000)
    seconds = found.tightest("out").seconds
    assert seconds <= max(exact, 0)
    assert seconds == 0 or seconds > exact - Fraction(1, 10**6) * (1 + abs(exact))


def test_how_far_the_signal_has_gone():
    """Threshold, noise, and what 6.1 N m/s move in 4 ms; the timer adds to that."""
    switch = OUT | {"torque": {"above": "0.1 N*m"}}
    found = logic(switch, BACK)
    assert values_at_switch(found, found.switches[0])["torque"] == pytest.approx(
        0.1 + 0.002 + 0.0244
    )
    held = logic(switch, BACK, hold={"in": "66 ms"})
    assert held.held_back("in") == Fraction(50, 1000)
    late = values_at_switch(held, held.switches[0])
    assert late["torque"] == pytest.approx(0.1 + 0.002 + 6.1 * 0.054)
    assert late["command"] < values_at_switch(found, found.switches[0])["command"] < 0


def test_the_switch_of_the_thesis_may_chatter():
    """Thesis 6.3.3: force from T_th on, position when the command is negative; both may hold."""
    there = {"from": "position", "to": "force", "torque": {"above": "0.3 N*m"}}
    back = {"from": "force", "to": "position", "command": {"below": "-0.5 deg/s"}}
    with pytest.raises(ValidationError, match="'position' may be left as soon as it is entered"):
        logic(there, back, start="position")
    mended = logic(there | {"command": {"above": "0.5 deg/s"}}, back, start="position")
    assert mended.stay("force").text == "0.016 s"
    held = logic(there, back, start="position", hold="50 ms")
    assert held.stay("force").text == "50 ms"
    assert held.held_back("force") == Fraction(50, 1000)
