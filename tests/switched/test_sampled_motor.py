"""Where the numbers of a sampled motor lie."""

from fractions import Fraction

import numpy as np

from nrs_design.models.actuator import ActuatorRanges
from nrs_design.spec.interval import Interval
from nrs_design.switched.sampled_motor import motor_box

PERIOD, TAU, KM = Fraction(1, 500), Fraction("0.0351"), Fraction("4.8417e-4")


def test_bounds_of_the_motor_hold_what_lies_between():
    """E and s at any time constant of the range lie within their axes."""
    tau = Interval(TAU, TAU * Fraction(9, 10), TAU * Fraction(11, 10))
    box = motor_box(ActuatorRanges(Interval.point(KM), tau, "rpm"), PERIOD).ranges
    Km, E, s = (box[symbol] for symbol in ("Km", "E", "s"))
    assert Km == Interval.point(KM)
    for share in np.linspace(0, 1, 50):
        value = float(tau.low + Fraction(float(share)) * (tau.high - tau.low))
        exponential = np.exp(-0.002 / value)
        assert float(E.low) <= exponential * (1 + 1e-12)
        assert exponential <= float(E.high) * (1 + 1e-12)
        assert float(s.low) <= value * (1 - exponential) * (1 + 1e-12)
        assert value * (1 - exponential) <= float(s.high) * (1 + 1e-12)
