"""The test of the stiffness in single precision, and its certain detections in words.

No rounding may tell a violation that there is not. With ``u = 2^-24``, a reading that is turned
into a float is off by ``u`` of itself, and so is the sum with an angle: ``ROUNDING`` times the
angle, a little more than ``2 u``, covers both. All other operations are on numbers of the size of
the noise and of the deflection; each loses ``u`` of it, five at most one after the other, and
``SLACK = 16 u`` is on the safe side in every number that they meet.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from nrs_design.controllers.float32 import float32_not_above, float32_not_below
from nrs_design.controllers.sector import DETECTION_FACTOR, Sector
from nrs_design.models.axis import unit
from nrs_design.proof.bounds import lower, upper

ROUNDING = Fraction(17, 2**27)
SLACK = Fraction(1, 2**20)
# Operations on larger numbers lose nothing to subnormal numbers.
TINY = Fraction(1, 2**100)
# Violations that a header tells of, as stiffness over the range; the largest angle there, in rad.
FACTORS = (Fraction(1, 2), Fraction(4, 5), Fraction(6, 5), Fraction(3, 2), Fraction(2), Fraction(4))
TURN = Fraction(22, 7)

Macro = tuple[str, Fraction, str]


def sector_macros(sector: Sector) -> Iterator[Macro]:
    """Yield name, number and comment of each number of the test."""
    yield (
        "TORQUE_NOISE",
        _enlarge(sector.torque_noise),
        f"{unit('N*m')}, a reading of the torque is off by",
    )
    yield "ANGLE_NOISE", _enlarge(sector.angle_noise), f"{unit('rad')}, its angle is off by"
    yield "ROUNDING", ROUNDING, "of an angle, single precision"
    yield "YIELD_MOST", _enlarge(1 / sector.low), f"{unit('rad/(N*m)')}, at the least stiffness"
    yield "YIELD_LEAST", _reduce(1 / sector.high), f"{unit('rad/(N*m)')}, at the largest stiffness"
    yield (
        "JUDGED_HIGH",
        _reduce(DETECTION_FACTOR * sector.high, 4),
        f"{unit('N*m/rad')}, below it for certain counts as judged",
    )
    yield (
        "JUDGED_LOW",
        _enlarge(sector.low / DETECTION_FACTOR, 4),
        f"{unit('N*m/rad')}, and above it",
    )
    if sector.surface_speed:
        yield "SURFACE_SPEED", _enlarge(sector.surface_speed), f"{unit('rad/s')}, of the surface"
    if sector.speed is not None:
        yield "JOINT_SPEED", _enlarge(sector.speed), f"{unit('rad/s')}, of the joint"
        yield "JOINT_NOISE", _enlarge(2 * sector.reading), f"{unit('rad')}, two readings of it"


def _enlarge(value: Fraction, slacks: int = 1) -> Fraction:
    return float32_not_below(value * (1 + slacks * SLACK) + TINY)


def _reduce(value: Fraction, slacks: int = 1) -> Fraction:
    return float32_not_above(value * (1 - slacks * SLACK))


def sector_words(sector: Sector, travel: Fraction) -> Iterator[str]:
    """Yield the reports of the test, and its certain detections.

    `travel` is how far the joint moves between two torques that are read, in rad.
    """
    low, high = lower(sector.low, 6), upper(sector.high, 6)
    yield (
        f"STIFFNESS: no stiffness within [{low}, {high}] {unit('N*m/rad')}, another one at "
        "every sample, explains the readings; the torque is off by at most "
        f"{upper(sector.torque_noise, 4)} {unit('N*m')}, its angle by "
        f"{upper(sector.angle_noise, 4)} {unit('rad')}; {_surface(sector)}. Where that holds it is "
        "never told, whatever stiffness and noise do, rounding included. Noise is a bound: "
        "three standard deviations of a normal one are left in nearly every run."
    )
    yield (
        "Found for certain: a stiffness c times the end of the range beyond which it is, from the "
        "torque N on (k times the deflection, without damping), where contact is made while the "
        f"monitor runs. N = {_formula(sector)}; e and "
        "a are the noise of torque and angle, l and h the ends of the range, d is the travel of "
        f"the joint between two torques that are read, {upper(travel, 3)} {unit('rad')} at the "
        f"velocity limit.{_moving(sector)}"
    )
    for factor in FACTORS:
        need = _need(sector, factor, Fraction(0))
        increase = _need(sector, factor, travel) - need
        torque = unit("N*m")
        yield (
            f"c = {float(factor):g}: N = {upper(need, 3)} {torque}, "
            f"and {upper(increase, 2)} {torque} for d"
        )
    yield (
        f"In `judged` of `sample` samples {float(DETECTION_FACTOR):g} times the range would have "
        "been told, whatever the noise: the stiffness was nearer, if it was in its range before."
    )


def _surface(sector: Sector) -> str:
    if sector.contact_maintained:
        return "contact is kept, with one surface"
    return {
        "fixed": "there is one surface for the whole run",
        "free": "the surface has moved since a reading only if the next torque may be zero",
        "touched": "the surface stands still from the first torque that is not zero for certain on",
    }[sector.surface]


def _formula(sector: Sector) -> str:
    """Return how N follows, as `Sector.need` has it."""
    noise, light = (
        "4 a + 2 e (1/l + 1/h)",
        "c {k} d" if sector.contact_maintained else "(2 e + c {k} d)",
    )
    stiff, soft = (
        f"({noise} + {light.format(k=k)} ({lever}))/({gain})"
        for k, lever, gain in (
            ("h", "1/l - 1/(c h)", "1/h - 1/(c h)"),
            ("l", "1/(c l) - 1/h", "1/(c l) - 1/l"),
        )
    )
    if sector.surface != "touched" and not sector.contact_maintained:
        stiff = f"({noise} + d)/(1/h - 1/(c h))"
    after = ", where the torque comes down to zero" if sector.contact_maintained else ""
    return f"{stiff} for c > 1, {soft} for c < 1{after}"


def _moving(sector: Sector) -> str:
    """Return the additional need for a moving surface, as text."""
    if not sector.surface_speed:
        return ""
    return (
        " A surface that moves adds twice its speed times the time between the two samples to 4 a."
    )


def _need(sector: Sector, factor: Fraction, travel: Fraction) -> Fraction:
    """Return the torque with what single precision costs up to half a turn.

    Each of two surfaces is moved by `ROUNDING` of the angle, and by ``2 u`` of it in rounding.
    """
    return sector.need(factor, travel, 4 * ROUNDING * TURN) * (1 + 16 * SLACK)
