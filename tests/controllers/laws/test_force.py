from fractions import Fraction

import pytest

from nrs_design.controllers.float32 import to_float32
from nrs_design.controllers.laws import ProportionalForce
from nrs_design.spec.controllers import ForceControllerSpec

FIXED = ForceControllerSpec(type="force", environment="soft", proportional_gain="0.02 rad/(N*m)")
CHOSEN = ForceControllerSpec(type="force", environment="soft", damping_ratio="0.741")
SHIPPED = to_float32(Fraction("0.02"))


def test_the_force_turns_the_command_back():
    """Thesis 6.46: on a spring with k = 43 N m/rad, the correction is -Kp k times the angle."""
    command, rates = ProportionalForce(Fraction(1, 50)).respond([Fraction(43), Fraction(0)], [])
    assert command == [Fraction(-43, 50), 0]
    assert rates == []


@pytest.mark.parametrize(
    ("given", "gain", "fault"),
    [
        (FIXED, SHIPPED, None),
        # What ships is a single-precision number: the decimal itself is another one.
        (FIXED, Fraction("0.02"), "not what the spec fixes"),
        (FIXED, 2 * SHIPPED, "not what the spec fixes"),
        (CHOSEN, SHIPPED, None),
        (CHOSEN, Fraction(0), None),
        (CHOSEN, -SHIPPED, "negative"),
    ],
)
def test_gains_that_the_spec_allows(given, gain, fault):
    found = ProportionalForce(gain).find_fault(given)
    assert found == (fault and f"gain Kp is {fault}")
