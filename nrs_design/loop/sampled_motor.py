"""Where the numbers of a sampled motor lie, which are exponentials of those of the motor."""

from __future__ import annotations

from fractions import Fraction
from math import ceil, floor

from nrs_design.loop.parameter_box import Box, Triangle
from nrs_design.models.actuator import ActuatorRanges
from nrs_design.models.interval import Interval
from nrs_design.proof.taylor import exponential_between

ZERO = Fraction(0)

# Binary digits of the enclosure of an exponential: its ends are one number in doubles, by which a
# search knows that they are one mode.
EXPONENTIAL_BITS = 56
# Where tau has a range, each digit costs time in every proof.
RANGED_BITS = 32
# Of s, per period, there are this many more.
MORE_BITS = 4
# The triangle is longer than the curve by one part in so many at both ends, so that what is rounded
# there hardly turns its sides; at the slow end by no more of what is left to one, where a motor
# would not slow down.
ROOM = 2**10


def motor_box(ranges: ActuatorRanges, period: Fraction) -> Box:
    """Return where Km, ``E = exp(-T/tau)`` and ``s = tau (1 - E)`` lie, T in s.

    Where tau is known, s is affine in E and is left out. Else both rise with tau, and ``s/T`` is
    the integral of ``E^t`` over t from 0 to 1: concave in E. So the curve is above the chord
    between its ends and below its tangents there (docs/certificates/ranges.md).
    """
    tau = ranges.time_constant
    fast, slow = (exponential_between(-period / end) for end in (tau.low, tau.high))
    if tau.low == tau.high:
        unit = Fraction(1, 2**EXPONENTIAL_BITS)
        E_low, E_high = _down(fast[0], unit), _up(slow[1], unit)
        return Box({"Km": ranges.gain, "E": Interval(E_low, E_low, E_high)})
    unit = Fraction(1, 2**RANGED_BITS)
    room = _up(min(slow[1] - fast[0], 1 - slow[1]) / ROOM, unit)
    E_low, E_high = max(_down(fast[0], unit) - room, Fraction(0)), _up(slow[1], unit) + room
    finer = unit / 2 ** (MORE_BITS + ceil(1 / period).bit_length())
    first, last = tau.low * (1 - fast[1]), tau.high * (1 - slow[0])
    # The tangent at the slow end is flatter than all of the curve. Where E is next to nothing,
    # a line that is level leads less far beyond the end.
    flat = max(_slope(period, tau.high, slow[1]), Fraction(0))
    flat = flat if flat * (E_high - slow[0]) * ROOM < 4 * (last - first) else Fraction(0)
    s_high = _up(last + flat * (E_high - slow[0]), finer)
    # The chord is below points that are not above the ends, nor left of them.
    ends = ((fast[1], first), (slow[1], tau.high * (1 - slow[1])))
    s_low = min(s_high - (s_high - s) * (E_high - E_low) / (E_high - E) for E, s in ends)
    s_low = _down(s_low, finer)
    # Left of both tangents, their corner may be too high, but not too low.
    E, s = E_low, s_high - flat * (E_high - E_low)
    if E_low < fast[0]:
        # Not flatter than the tangent at the fast end, which must not be above the line.
        risen = (tau.low * (1 - fast[0]) - s_low) / (fast[0] - E_low)
        steep = max(_slope(period, tau.low, fast[0]), risen)
        E = E_low + max(_down((s - s_low) / (steep - flat), unit), Fraction(0))
        s = max(s_high - flat * (E_high - E), s_low + steep * (E - E_low))
    box = {"E": Interval(E_low, E_low, E_high), "s": Interval(s_low, s_low, s_high)}
    return Box({"Km": ranges.gain, **box}, triangle=Triangle("E", "s", (E, _up(s, finer))))


def way_between(time: Fraction, rate: Interval) -> tuple[Fraction, Fraction]:
    """Enclose ``(1 - exp(-g h)) / g``: how far a motor of speed 1 goes on in a time h in s.

    The rate g, in 1/s, is positive: the larger it is, the shorter the way.
    """
    if not time:
        return ZERO, ZERO
    fast, _ = exponential_between(-time * rate.low)
    _, slow = exponential_between(-time * rate.high)
    unit = way_unit(time, rate)
    return _down((1 - slow) / rate.high, unit), _up((1 - fast) / rate.low, unit)


def way_unit(time: Fraction, rate: Interval) -> Fraction:
    """Return the digit to which ways in a time are rounded; fewer where motors have a range."""
    bits = EXPONENTIAL_BITS if rate.low == rate.high else RANGED_BITS + MORE_BITS
    return Fraction(1, 2 ** (bits + ceil(1 / time).bit_length()))


def _slope(period: Fraction, tau: Fraction, E: Fraction) -> Fraction:
    """Return ds/dE, which is not below that of the motor where E is not above its number."""
    x = period / tau
    return period * (1 / E - 1 - x) / x**2


def _down(value: Fraction, unit: Fraction) -> Fraction:
    return floor(value / unit) * unit


def _up(value: Fraction, unit: Fraction) -> Fraction:
    return ceil(value / unit) * unit
