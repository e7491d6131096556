"""The test of the stiffness in single precision, and what it finds for certain, in words.

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
from nrs_design.controllers.sector import JUDGED, Sector
from nrs_design.proof.bounds import lower, upper

ROUNDING = Fraction(17, 2**27)
SLACK = Fraction(1, 2**20)
# No operation on what is not below it loses anything to subnormal numbers.
TINY = Fraction(1, 2**100)
# Violations that a header tells of, as stiffness over the range; the largest angle there, in rad.
FACTORS = (Fraction(1, 2), Fraction(4, 5), Fraction(6, 5), Fraction(3, 2), Fraction(2), Fraction(4))
TURN = Fraction(22, 7)

Macro = tuple[str, Fraction, str]


def sector_macros(sector: Sector) -> Iterator[Macro]:
    """Yield what each number of the test is called, the number, and what stands beside it.

    Parameters
    ----------
    sector : Sector
        What readings must keep.
    """
    yield "TORQUE_NOISE", _more(sector.torque_noise), "N*m, a reading of the torque is off by"
    yield "ANGLE_NOISE", _more(sector.angle_noise), "rad, its angle is off by"
    yield "ROUNDING", ROUNDING, "of an angle, single precision"
    yield "YIELD_MOST", _more(1 / sector.low), "rad/(N*m), at the least stiffness"
    yield "YIELD_LEAST", _less(1 / sector.high), "rad/(N*m), at the largest stiffness"
    yield "JUDGED_HIGH", _less(JUDGED * sector.high, 4), "N*m/rad, below it for certain is judged"
    yield "JUDGED_LOW", _more(sector.low / JUDGED, 4), "N*m/rad, and above it"
    if sector.surface_speed:
        yield "SURFACE_SPEED", _more(sector.surface_speed), "rad/s, of the surface"
    if sector.speed is not None:
        yield "JOINT_SPEED", _more(sector.speed), "rad/s, of the joint"
        yield "JOINT_NOISE", _more(2 * sector.reading), "rad, two readings of it"


def _more(value: Fraction, slacks: int = 1) -> Fraction:
    return float32_not_below(value * (1 + slacks * SLACK) + TINY)


def _less(value: Fraction, slacks: int = 1) -> Fraction:
    return float32_not_above(value * (1 - slacks * SLACK))


def sector_words(sector: Sector, travel: Fraction) -> Iterator[str]:
    """Yield what the test tells, and what it finds for certain.

    Parameters
    ----------
    sector : Sector
        What readings must keep.
    travel : Fraction
        How far the joint moves between two torques that are read, at the velocity limit, in rad.
    """
    low, high = lower(sector.low, 6), upper(sector.high, 6)
    yield (
        f"STIFFNESS: no stiffnesses in [{low}, {high}] N*m/rad, another one at every sample, "
        f"explain the readings, which are off by at most {upper(sector.torque_noise, 4)} N*m and "
        f"{upper(sector.angle_noise, 4)} rad; {_SURFACES[sector.surface]}. Where that holds it is "
        "never told, whatever the stiffness and the noise do: a theorem, rounding included. These "
        "are bounds: of normal noise, three standard deviations are left in nearly every run."
    )
    yield (
        "Found for certain, whatever the noise does: a stiffness c times the range once its torque "
        f"is beyond N. With e, a the noise of torque and angle, l, h the range, {_FORMULA}"
    )
    for factor in FACTORS:
        need = _need(sector, factor, Fraction(0))
        more = _need(sector, factor, travel) - need
        yield f"c = {float(factor):g}: N = {upper(need, 3)} N*m, and {upper(more, 2)} N*m for d"
    yield (
        f"d here: {upper(travel, 3)} rad, at the velocity limit. Contact has to be made while it "
        "watches. What noise happens not to hide is found from half of that on."
    )


_SURFACES = {
    "fixed": "there is one surface for the whole run",
    "free": "the surface moves only where the torque may be zero",
    "touched": "the surface moves until contact is certain",
}
_FORMULA = (
    "d the travel of the joint between two readings of the torque, and k = c h for c > 1, c l for "
    "c < 1: N = (4 a + 2 e (1/l + 1/h) + m)/|1/k - 1/b|, where b is h for c > 1, l for c < 1; m = "
    "d for c > 1 if the surface is fixed or free, else (2 e + k d) |1/k - 1/o|, o the other end. "
    "If contact is kept, k d counts from the least torque, and without 2 e."
)


def _need(sector: Sector, factor: Fraction, travel: Fraction) -> Fraction:
    """Return the torque with what single precision costs up to half a turn."""
    return sector.need(factor, travel, 4 * 2 * ROUNDING * TURN) * (1 + 16 * SLACK)
