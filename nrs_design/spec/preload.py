"""A power law over a range of deflections, as the box of springs and dampers that it stays in.

The law is ``F = rho delta^phi + lam delta^phi delta'`` (thesis 2.18), ``phi >= 1``. A spec gives
its tangent at one deflection a, ``k = phi rho a^(phi-1)`` and ``b = lam a^phi``: no power of phi is
in their units, and errors of rho and phi do not multiply.

While delta stays in the preload [low, high], and about a rest at any delta_e in [0, high],
``F(delta, delta') - F(delta_e, 0) = K (delta - delta_e) + B delta'`` exactly, with the chord K of
``rho delta^phi`` and ``B = lam delta^phi``. The law is convex, so chords grow with both their ends:
K is at least the chord from the surface to low, ``k/phi (low/a)^(phi-1)``, and at most the tangent
at high, ``k (high/a)^(phi-1)``. B lies between ``b (low/a)^phi`` and ``b (high/a)^phi``. A power is
monotonic in phi, so the ends of its range suffice.
"""

from __future__ import annotations

from fractions import Fraction
from math import floor, log10
from typing import Annotated

from nrs_design.models.interval import Interval
from nrs_design.spec.faults import fault
from nrs_design.spec.fields import NUMBER_SCHEMA, read_exact
from nrs_design.spec.model import (
    ExpandedBy,
    ParsedBy,
    SpecModel,
    keys_schema,
    pair_schema,
    required,
)
from nrs_design.spec.parameters import RANGE_CHECKS, range_around

# Powers are enclosed in integers with as many digits as the denominator is large.
FINEST = 1000
LEAST, LARGEST = 1, 3


def _read_exponent(value: object) -> Fraction:
    number = read_exact(value)
    if not LEAST <= number <= LARGEST:
        raise fault(
            f"the exponent {value} is not between {LEAST} and {LARGEST}",
            "write phi of F = rho delta^phi, usually 1.1 to 1.3",
        )
    if number.denominator > FINEST:
        raise fault(
            f"the exponent {value} is finer than 1/{FINEST}",
            "write at most three decimals; a range is rounded outwards",
        )
    return number


_NOMINAL = "exponent that the design uses, no unit"
_RANGE = "[lowest, highest] exponent that the proof covers; default: the nominal one"
_KEYS = {
    "nominal": NUMBER_SCHEMA | {"description": _NOMINAL},
    "range": pair_schema(NUMBER_SCHEMA) | {"description": _RANGE},
}
_SCHEMA = {"anyOf": [NUMBER_SCHEMA, keys_schema(_KEYS, "nominal")]}
_Exponent = Annotated[Fraction, ParsedBy(_read_exponent, NUMBER_SCHEMA)]


class ExponentSpec(SpecModel):
    """An exponent that is known up to a range."""

    nominal: _Exponent = required(_NOMINAL)
    range: tuple[_Exponent, _Exponent] = range_around(_RANGE)

    checks = RANGE_CHECKS


RangedExponent = Annotated[
    ExponentSpec,
    ExpandedBy(lambda v: v if isinstance(v, dict | ExponentSpec) else {"nominal": v}, _SCHEMA),
]


# Digits of the bounds, at least.
DIGITS = 10


def power_between(base: Fraction, exponent: Fraction) -> tuple[Fraction, Fraction]:
    """Return decimals at most and at least ``base^exponent``, and nearly equal.

    With ``exponent = p/q`` and a unit u, ``r u`` is the lower one for the largest r with
    ``(r u)^q <= base^p``, and ``(r + 1) u`` the upper one, unless the lower one is the power. The
    base is positive, else a ValueError; numbers have as many digits as q is large.
    """
    # Loading it takes longer than reading a spec, and few specs have such powers.
    from flint import fmpz

    if base <= 0:
        raise ValueError(f"{base} has no power with a rational exponent")
    q, power = exponent.denominator, base**exponent.numerator
    # A float estimates the magnitude; it decides only how tight the bounds are.
    size = float(exponent) * (log10(base.numerator) - log10(base.denominator))
    unit = Fraction(10) ** (floor(size) - DIGITS)
    scaled = power / unit**q
    lower = int(fmpz(floor(scaled)).root(q))
    upper = lower if lower**q == scaled else lower + 1
    return lower * unit, upper * unit


def power_box(
    stiffness: Interval, damping: Interval, exponent: ExponentSpec, reach: tuple[Fraction, Fraction]
) -> tuple[Interval, Interval]:
    """Return where stiffness and damping stay while the deflection stays in its preload.

    From those of the tangent at the deflection a, and the lowest and highest preload over a. The
    ranges are rounded outwards; the nominal values are those at a.
    """
    low, high = reach
    ends = exponent.range
    softest = min(power_between(low, phi - 1)[0] for phi in ends) / ends[1]
    stiffest = max(power_between(high, phi - 1)[1] for phi in ends)
    least = min(power_between(low, phi)[0] for phi in ends)
    most = max(power_between(high, phi)[1] for phi in ends)
    return (
        Interval(stiffness.nominal, stiffness.low * softest, stiffness.high * stiffest),
        Interval(damping.nominal, damping.low * least, damping.high * most),
    )
