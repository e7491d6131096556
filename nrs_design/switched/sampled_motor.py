"""Where the numbers of a sampled motor lie, which are exponentials of those of the motor."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from nrs_design.models.actuator import ActuatorRanges
from nrs_design.proof.taylor import exponential_between
from nrs_design.spec.interval import Interval
from nrs_design.switched.parameter_box import Box

# Binary digits of the enclosure of an exponential: its ends are one number in doubles, by which a
# search knows that they are one mode.
EXPONENTIAL_BITS = 56
# Where tau has a range, each digit costs time in every proof.
RANGED_BITS = 32
# Of s, per period, there are this many more, so that its rounding hardly turns the chord.
MORE_BITS = 4


def motor_box(ranges: ActuatorRanges, period: Fraction) -> Box:
    """Return where Km, ``E = exp(-T/tau)`` and ``s = tau (1 - E)`` lie.

    Where tau is known, s is affine in E and is left out. Else both rise with tau, and ``s/T`` is
    the integral of ``E^t`` over t from 0 to 1: concave in E. So what lies below the two ends of the
    curve, as the chord of the box does, lies below all of it (docs/certificates/ranges.md).

    Parameters
    ----------
    ranges : ActuatorRanges
        Of gain and time constant, which last for a period.
    period : Fraction
        In s.
    """
    tau = ranges.time_constant
    fast, slow = (exponential_between(-period / end) for end in (tau.low, tau.high))
    unit = Fraction(1, 2 ** (EXPONENTIAL_BITS if tau.low == tau.high else RANGED_BITS))
    E_low, E_high = _down(fast[0], unit), _up(slow[1], unit)
    if tau.low == tau.high:
        return Box({"Km": ranges.gain, "E": Interval(E_low, E_low, E_high)})
    # Room between the end and the corner, so that the line to it is not steep.
    E_high += unit
    finer = unit / 2 ** (MORE_BITS + ceil(1 / period).bit_length())
    s_high = _up(tau.high * (1 - slow[0]), finer)
    # Points that are not above the curve's ends, nor left of them.
    ends = ((E, time * (1 - E)) for E, time in ((fast[1], tau.low), (slow[1], tau.high)))
    s_low = min(s_high - (s_high - s) * (E_high - E_low) / (E_high - E) for E, s in ends)
    s_low = _down(s_low, finer)
    box = {"E": Interval(E_low, E_low, E_high), "s": Interval(s_low, s_low, s_high)}
    return Box({"Km": ranges.gain, **box}, chord=("E", "s"))


def _down(value: Fraction, unit: Fraction) -> Fraction:
    return floor(value / unit) * unit


def _up(value: Fraction, unit: Fraction) -> Fraction:
    return ceil(value / unit) * unit
