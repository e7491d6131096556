from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import IntegralForce
from nrs_design.errors import SpecError
from nrs_design.spec import parse_spec
from nrs_design.spec.controllers import IntegralControllerSpec
from tests.simulation.interactions import POSITION, text_of

GAINS = {"proportional_gain": "0.02 rad/(N*m)", "integral_gain": "0.5 rad/(N*m*s)"}
FIXED = IntegralControllerSpec(type="pi-force", environment="soft", **GAINS)
CHOSEN = IntegralControllerSpec(
    type="pi-force", environment="soft", damping_ratio="0.741", settling_time="0.3 s"
)
KP, KI = to_float32(Fraction("0.02")), to_float32(Fraction("0.5"))


def test_the_integral_is_added_and_gathers_the_error():
    """On a spring of 43 N m/rad, of the states angle and integral."""
    law = IntegralForce(Fraction(1, 50), Fraction(1, 2))
    command, rates = law.respond([Fraction(43), Fraction(0)], [[Fraction(0), Fraction(1)]])
    assert command == [Fraction(-43, 50), 1]
    assert rates == [[Fraction(-43, 2), 0]]


def test_a_sample_adds_its_share_in_single_precision():
    law = IntegralForce(KP, KI).discretize(Fraction(1, 500), "exact")
    assert law.coefficients == {"Kp": KP, "Ki_T": to_float32(Fraction(1, 1000))}


@pytest.mark.parametrize(
    ("given", "gains", "fault"),
    [
        (FIXED, (KP, KI), None),
        (FIXED, (2 * KP, KI), "gain Kp is not what the spec fixes"),
        (FIXED, (KP, 2 * KI), "gain Ki is not what the spec fixes"),
        (CHOSEN, (2 * KP, 2 * KI), None),
        (CHOSEN, (KP, Fraction(0)), "gains Kp and Ki are not positive"),
        (CHOSEN, (-KP, KI), "gains Kp and Ki are not positive"),
    ],
)
def test_gains_that_the_spec_allows(given, gains, fault):
    assert IntegralForce(*gains).find_fault(given) == fault


@pytest.mark.parametrize(
    ("gains", "said"),
    [
        ("integral_gain: 0.5 rad/(N*m*s)", "neither proportional_gain nor damping_ratio"),
        ("proportional_gain: 0.02 rad/(N*m)", "neither integral_gain nor settling_time"),
        (
            "damping_ratio: 0.7, settling_time: 0.3 s, integral_gain: 0.5 rad/(N*m*s)",
            "integral_gain and settling_time exclude each other",
        ),
    ],
)
def test_each_gain_is_given_once(gains, said):
    force = f"{{type: pi-force, environment: soft, {gains}}}"
    with pytest.raises(SpecError, match=said):
        parse_spec(text_of({"force": force}))


PI = "{type: pi-force, environment: soft, proportional_gain: 0.02 rad/(N*m), "
PI += "integral_gain: 0.5 rad/(N*m*s)}"


def test_what_the_integral_does_meanwhile_has_to_be_said():
    both = {"position": POSITION, "force": PI}
    with pytest.raises(SpecError, match="it is not said what the states of pi-force"):
        parse_spec(text_of(both))
    assert parse_spec(text_of(both, more="idle_states: {decay: 20 1/s}")).idle_states
