"""The statement of a safety layer: what it claims, and that no number of it may be smaller."""

from dataclasses import fields, replace
from fractions import Fraction

import pytest

from nrs_design.proof.evidence import SafetyLayer, Shows
from nrs_design.proof.evidence.safety_layer import LONGEST
from nrs_design.proof.mode import Time
from nrs_design.proof.switching import Reset, Switching
from tests.proof.systems import family, genuine, governed, matrix

SYSTEM, EVIDENCE = genuine("safety-layer")
LOOP = SYSTEM.safety


def with_loop(**changed):
    return replace(SYSTEM, safety=replace(LOOP, **changed))


def test_it_holds_and_says_what_is_kept():
    assert EVIDENCE.find_fault(SYSTEM) is None
    assert EVIDENCE.shows is Shows.SAFETY
    assert EVIDENCE.kept_speed == EVIDENCE.limits.velocity
    assert genuine("common-quadratic")[1].kept_speed is None
    claim = EVIDENCE.claim(SYSTEM)
    for words in (
        "in contact of at most 0.5 N*m",
        "within 2 rad",
        "20 to 40 N*m/rad times its deflection, and at most 0.125 N*m*s/rad times its rate",
        "at most 0.015625 J + n ",
        "at most 0.25 rad/s",
        "changes no bit",
    ):
        assert words in claim
    assert "times its rate" not in EVIDENCE.claim(with_loop(damping=Fraction(0)))


@pytest.mark.parametrize("part", ["reach", "limits"])
def test_no_number_may_be_smaller(part):
    held = getattr(EVIDENCE, part)
    for field in fields(held):
        less = getattr(held, field.name) * (1 - Fraction(1, 10**4))
        changed = replace(EVIDENCE, **{part: replace(held, **{field.name: less})})
        assert changed.find_fault(SYSTEM) is not None, field.name


def test_larger_limits_hold_and_a_larger_reach_needs_them():
    looser = replace(EVIDENCE.limits, torque=2 * EVIDENCE.limits.torque)
    assert replace(EVIDENCE, limits=looser).find_fault(SYSTEM) is None
    wider = replace(EVIDENCE.reach, velocity=2 * EVIDENCE.reach.velocity)
    assert "beyond" in replace(EVIDENCE, reach=wider).find_fault(SYSTEM)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"gain": (Fraction("0.98"), Fraction("1.01"))}, "sample can take"),
        ({"speed": Fraction(26, 100)}, "sample can take"),
        ({"friction": Fraction(2, 1000)}, "sample can take"),
        ({"encoder": Fraction(2, 10_000)}, "sample can take"),
        ({"angle": Fraction(2000)}, "sample can take"),
        ({"oldest": 2}, "limit of depth"),
        ({"sensor": Fraction(2, 1000)}, "limit of torque"),
        ({"damping": Fraction(2, 8)}, "limit of torque"),
        ({"stiffness": (Fraction(19), Fraction(40))}, "limit of torque"),
        ({"stiffness": (Fraction(20), Fraction(41))}, "limit of torque"),
        ({"torque": Fraction(51, 100)}, "limit of torque"),
        ({"energy": Fraction(1)}, "limit of lost"),
        ({"command": Fraction(1, 4)}, "may saturate"),
        ({"tick": Fraction(1, 101)}, "holds is another one"),
        ({"tick": Fraction(1, 99)}, "holds is another one"),
        ({"Kp": Fraction(61, 3)}, "not of binary digits"),
        ({"D": Fraction(16, 3)}, "not of binary digits"),
        ({"Kp": Fraction(0)}, "a number that no layer has"),
        ({"Kp": Fraction(300)}, "has not died down"),
    ],
)
def test_it_is_about_this_loop_alone(changed, words):
    assert words in EVIDENCE.find_fault(with_loop(**changed))


def test_a_weaker_loop_has_it_too():
    for changed in (
        {"speed": Fraction(24, 100)},
        {"oldest": 0},
        {"damping": Fraction(0)},
        {"command": None},
        {"stiffness": (Fraction(21), Fraction(39))},
    ):
        assert EVIDENCE.find_fault(with_loop(**changed)) is None


def test_an_angle_that_goes_back_has_no_statement():
    loop = with_loop(
        gain=(Fraction(1),) * 2,
        time_constant=(Fraction(3, 1000),) * 2,
        Kp=Fraction(100),
        D=Fraction(160),
    )
    assert "go back" in replace(EVIDENCE, horizon=60).find_fault(loop)


@pytest.mark.parametrize("horizon", [0, LONGEST + 1])
def test_a_horizon_has_its_limits(horizon):
    assert "horizon" in replace(EVIDENCE, horizon=horizon).find_fault(SYSTEM)


def test_without_a_layer_it_says_nothing():
    bare = family([["1/2"]], time=Time.DISCRETE)
    assert EVIDENCE.find_fault(bare) == "the system has no safety layer"
    assert EVIDENCE.find_fault(replace(SYSTEM, sample_time=None)) is not None
    with pytest.raises(ValueError, match="no safety layer"):
        SafetyLayer.from_fields(EVIDENCE.to_fields(), bare)
    assert SafetyLayer.from_fields(EVIDENCE.to_fields(), SYSTEM) == EVIDENCE


def test_switches_and_resets_of_the_controllers_do_not_matter():
    rules = Switching(resets=(Reset("m0", "m0", matrix([[2]])),))
    assert EVIDENCE.fits(rules)


def test_the_layer_is_a_part_of_what_the_certificate_is_about():
    assert governed() == SYSTEM
    assert replace(SYSTEM, safety=None) != SYSTEM
