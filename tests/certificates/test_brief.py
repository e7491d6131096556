"""A brief says no more than the claim: its numbers, signals, contact and rounding."""

import re
from dataclasses import replace
from fractions import Fraction
from unittest.mock import patch

import pytest

from nrs_design.certificates.brief import brief
from nrs_design.proof.evidence.abstract import Shows
from tests.proof.systems import SYSTEMS, genuine

NUMBER = re.compile(r"(?<![\w.])\d+(?:\.\d+)?(?:e-?\d+)?")


@pytest.mark.parametrize("example", SYSTEMS)
def test_every_kind_is_said_in_a_line(example):
    system, evidence = genuine(example)
    said = brief(evidence, system)
    assert said
    assert "\n" not in said
    assert len(said.split()) <= 50
    loses = system.contact is not None or system.flights is not None
    assert not ("may be lost" in said and not (loses and evidence.covers_lost_contact))
    assert ("rounding included" in said) <= evidence.covers_rounding
    unrounded = evidence.shows.is_good and system.roundings and not evidence.covers_rounding
    assert ("without rounding" in said) == bool(unrounded)


@pytest.mark.parametrize("example", SYSTEMS)
def test_rates_are_on_the_safe_side(example):
    system, evidence = genuine(example)
    rate = evidence.proved_rate(system)
    if evidence.shows is not Shows.STABILITY or rate is None:
        return
    said = brief(evidence, system)
    if (found := re.search(r"alpha (?:>=|=) (\S+) 1/s", said)) is not None:
        step = system.sample_time
        alpha = rate if step is None else (1 - rate) / step
        assert Fraction(found[1]) <= alpha
        time, unit = re.search(r"time constant at most (\S+) (ms|s)", said).groups()
        assert Fraction(time) / (1000 if unit == "ms" else 1) * alpha >= 1
    else:
        found = re.search(r"rho (?:<=|=) (\S+)", said)
        assert Fraction(found[1]) >= rate


def test_turns_and_missed_deadlines_are_no_arbitrary_switching():
    system, evidence = genuine("periodic-quadratic")
    assert "in rounds of 2 steps" in brief(evidence, system)
    ahead = replace(system.clock, ahead=((0, 1), (0, -1)))
    assert "deadlines missed as the rule allows" in brief(evidence, replace(system, clock=ahead))


def test_a_torque_is_said_as_a_force_rounded_up():
    system, evidence = genuine("invariant-ellipsoid")
    bound = evidence.bound(system)
    output = replace(bound.output, unit="N*m", limit=None)
    torque = replace(bound, level=Fraction(1), output=output)
    with patch.object(type(evidence), "bound", return_value=torque):
        assert "<= 1 N*m (3.334 N at 0.3 m) from rest" in brief(evidence, system, Fraction(3, 10))
        assert "<= 1 N*m from rest" in brief(evidence, system)


@pytest.mark.parametrize(("limit", "said"), [(1, "within"), (Fraction(1, 2), "not shown to keep")])
def test_a_limit_stands_beside_its_bound(limit, said):
    system, evidence = genuine("invariant-ellipsoid")
    bound = evidence.bound(system)
    output = replace(bound.output, unit="N*m", limit=Fraction(limit))
    torque = replace(bound, level=Fraction(1), output=output)
    with patch.object(type(evidence), "bound", return_value=torque):
        assert f"1 N*m ({said} its limit of {float(limit):g} N*m) from" in brief(evidence, system)
