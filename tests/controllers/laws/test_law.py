"""What laws respond, which gains they allow, and what a law is until it says more of itself."""

from dataclasses import dataclass
from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import round_float32
from nrs_design.controllers.laws import (
    AbstractCompliantLaw,
    Admittance,
    IntegralForce,
    ProportionalForce,
)
from nrs_design.spec.controllers import (
    ForceControllerSpec,
    IntegralControllerSpec,
    PositionControllerSpec,
)

F = Fraction
POSITION = PositionControllerSpec(type="position")
KP, KI = round_float32(F("0.02")), round_float32(F("0.5"))
GAINS = {"proportional_gain": "0.02 rad/(N*m)", "integral_gain": "0.5 rad/(N*m*s)"}
CHOSEN = {"environment": "soft", "damping_ratio": "0.741"}
P = ForceControllerSpec(type="force", environment="soft", proportional_gain="0.02 rad/(N*m)")
FREE_P = ForceControllerSpec(type="force", **CHOSEN)
PI = IntegralControllerSpec(type="pi-force", environment="soft", **GAINS)
FREE_PI = IntegralControllerSpec(type="pi-force", **CHOSEN, settling_time="0.3 s")
NOT_POSITIVE = "gains Kp and Ki are not positive"


@dataclass(frozen=True, slots=True)
class Unbounded(AbstractCompliantLaw):
    """A law that says nothing of the gain that its spec does not bound."""

    K: Fraction

    def respond(self, force, states):
        return force, states

    def discretize(self, period, method):
        raise NotImplementedError


@pytest.mark.parametrize(
    ("law", "given", "fault"),
    [
        (ProportionalForce(KP), P, None),
        # What ships is a single-precision number: the decimal itself is another one.
        (ProportionalForce(F("0.02")), P, "gain Kp is not what the spec fixes"),
        (ProportionalForce(2 * KP), P, "gain Kp is not what the spec fixes"),
        (ProportionalForce(KP), FREE_P, None),
        (ProportionalForce(F(0)), FREE_P, None),
        (ProportionalForce(-KP), FREE_P, "gain Kp is negative"),
        (IntegralForce(KP, KI), PI, None),
        (IntegralForce(2 * KP, KI), PI, "gain Kp is not what the spec fixes"),
        (IntegralForce(KP, 2 * KI), PI, "gain Ki is not what the spec fixes"),
        (IntegralForce(2 * KP, 2 * KI), FREE_PI, None),
        (IntegralForce(KP, F(0)), FREE_PI, NOT_POSITIVE),
        (IntegralForce(-KP, KI), FREE_PI, NOT_POSITIVE),
        # A certificate may quote any gain: one that nothing is held against must not pass.
        (Unbounded(F(1)), POSITION, "gain K has no bounds in the spec"),
    ],
)
def test_gains_that_the_spec_allows(law, given, fault):
    assert law.find_fault(given) == fault


@pytest.mark.parametrize(
    ("law", "states", "command", "rates"),
    [
        (ProportionalForce(F(1, 50)), [], [F(-43, 50), 0], []),
        (IntegralForce(F(1, 50), F(1, 2)), [[F(0), F(1)]], [F(-43, 50), 1], [[F(-43, 2), 0]]),
    ],
)
def test_the_force_turns_the_command_back(law, states, command, rates):
    """Thesis 6.46: on a spring with k = 43 N m/rad; of the states angle and integral."""
    assert law.respond([F(43), F(0)], states) == (command, rates)


def test_gains_are_taken_by_name():
    gains = {"Bt": F(2), "Mt": F(1), "other": F(3)}
    assert Admittance.create(gains) == Admittance(Mt=F(1), Bt=F(2))
    with pytest.raises(KeyError, match="Bt"):
        Admittance.create({"Mt": F(1)})


def test_a_sample_adds_its_share_of_the_integral_in_single_precision():
    law = IntegralForce(KP, KI).discretize(F(1, 500), "exact")
    assert law.coefficients == {"Kp": KP, "Ki_T": round_float32(F(1, 1000))}
