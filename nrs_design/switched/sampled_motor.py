"""Where the numbers of a sampled motor lie, which are exponentials of those of the motor."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from nrs_design.models.actuator import ActuatorRanges
from nrs_design.proof.taylor import exponential_between
from nrs_design.spec.interval import Interval
from nrs_design.switched.parameter_box import Box

# Binary digits of the enclosures of exponentials.
EXPONENTIAL_BITS = 56


def motor_box(ranges: ActuatorRanges, period: Fraction) -> Box:
    """Return where Km, ``E = exp(-T/tau)`` and ``s = tau (1 - E)`` lie.

    Both rise with tau: the derivative of s is ``1 - (1 + x) exp(-x)`` at ``x = T/tau``, positive.
    Where tau is known, s is affine in E and is left out.

    Parameters
    ----------
    ranges : ActuatorRanges
        Of gain and time constant.
    period : Fraction
        In s.
    """
    tau = ranges.time_constant
    below, above = _between(-period / tau.low), _between(-period / tau.high)
    box = Box({"Km": ranges.gain, "E": Interval(below[0], below[0], above[1])})
    if tau.low == tau.high:
        return box
    lowest, highest = tau.low * (1 - below[1]), tau.high * (1 - above[0])
    return box.beside(Box({"s": Interval(lowest, lowest, highest)}))


def _between(exponent: Fraction) -> tuple[Fraction, Fraction]:
    """Enclose an exponential between short numbers."""
    low, high = exponential_between(exponent)
    unit = Fraction(1, 2**EXPONENTIAL_BITS)
    return floor(low / unit) * unit, ceil(high / unit) * unit
