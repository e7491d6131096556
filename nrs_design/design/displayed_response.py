"""What the surgeon feels and how well the tool follows, bounded over a band and all ranges.

The **displayed impedance** ``Z = F/V`` is the force of the hand over the velocity of the tool, in
free motion: ``Z = D/N``, with the characteristic polynomial D of the assembled mode that touches
nothing and ``D + b N`` that with a damper b, as in `nrs_design.design.passivity`. The **tracking
error** is ``|1 - V/Vcmd|`` of a commanded velocity. With the part M of N that passes the law,
``M/D = G H Y``, so V/Vcmd is ``M/(H Y)`` over D in free motion, and over the characteristic
polynomial of the mode in contact else.

Times Mt (or Bt without inertia) and the time constant, all of these are affine in each of Km, tau,
Mt, Bt, Kt, and k and b of the contact; so the squares of the magnitudes are polynomials in omega^2
and of second degree in each parameter, and `nrs_design.design.largest_ratio` bounds their quotient.
Each parameter is unknown but constant: that is what a frequency response is about.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isqrt
from typing import Any

from nrs_design.controllers.laws import Admittance, CompliantLaw
from nrs_design.controllers.sensor import LowPass
from nrs_design.design.affine_family import (
    ONE,
    ZERO,
    FrequencyPiece,
    Polynomial,
    Quotient,
    Response,
    Squares,
    as_fmpq,
    is_stable_over,
    polynomial,
)
from nrs_design.errors import InternalError
from nrs_design.loop.cut_loop import ContinuousAxis, Place
from nrs_design.models.contact import KelvinVoigt
from nrs_design.models.interval import Interval

# Digits of a root, and what makes it one from above.
_DIGITS = 20
_ABOVE = Fraction(1, 10**_DIGITS)

Band = tuple[Fraction, Fraction]  # In rad/s


@dataclass(frozen=True, slots=True)
class LargestResponse:
    """Two bounds on the largest magnitude over a band and ranges."""

    # No parameters in their ranges and no frequency in the band give more; None if not shown.
    above: Fraction | None
    below: Fraction  # At one point there is at least this
    square: Fraction  # Of the frequency there in rad/s, exactly
    at: Mapping[str, Fraction]  # The parameters there, exactly
    omega: float  # The frequency in rad/s, for people


def largest_impedance(
    axis: ContinuousAxis,
    law: CompliantLaw,
    ranges: Mapping[str, Interval],
    band: Band,
    limit: Fraction | None = None,
) -> LargestResponse | None:
    """Bound the largest displayed impedance, in N m s/rad, over a band in rad/s.

    Ranges are those of ``Km``, ``tau``, ``Mt``, ``Bt``, ``Kt``, as far as they have any. None where
    the robot that nobody holds is not shown to be stable.
    """
    at = impedance_at(axis, law)
    return largest_over(at, ranges, band, limit) if is_stable_over(at, ranges) else None


def impedance_at(axis: ContinuousAxis, law: CompliantLaw) -> Response:
    """Return the displayed impedance as a function of the parameters."""

    def at(values: Mapping[str, Fraction]) -> Quotient:
        held, place, factor = parameters_at(axis, law, values)
        free, damped = (
            factor * polynomial(*axis.cut(held, KelvinVoigt(ZERO, b), place).closed)
            for b in (ZERO, ONE)
        )
        return Quotient(free, damped - free, _poles_in_the_air(held, free))

    return at


def largest_tracking_error(
    axis: ContinuousAxis,
    law: CompliantLaw,
    ranges: Mapping[str, Interval],
    band: Band,
    limit: Fraction | None = None,
    *,
    in_contact: bool = False,
) -> LargestResponse | None:
    """Bound the largest ``|1 - V/Vcmd|``, a share of the commanded velocity, over a band in rad/s.

    Ranges as for `largest_impedance`, and ``k`` and ``b`` of what is touched; in free motion the
    law has no part in it. None where the loop is not shown to be stable.
    """
    if not in_contact:
        # Any law will do: the simplest.
        axis, law = replace(axis, low_pass=None), Admittance(ZERO, ONE)
        ranges = {name: r for name, r in ranges.items() if name in ("Km", "tau")}

    def at(values: Mapping[str, Fraction]) -> Quotient:
        held, place, factor = parameters_at(axis, law, values)
        damped = axis.cut(held, KelvinVoigt(ZERO, ONE), place)
        touched = KelvinVoigt(values.get("k", ZERO), values.get("b", ZERO))
        closed = factor * polynomial(*axis.cut(held, touched, place).closed)
        passed = factor * (polynomial(*damped.closed) - polynomial(*damped.opened))
        # The spring of the law is one over s.
        below = closed.left_shift(1) if held.gains.get("Kt") else closed
        poles = closed if in_contact else _poles_in_the_air(held, closed)
        return Quotient(below - passed * over_admittance(held, axis.low_pass), below, poles)

    return largest_over(at, ranges, band, limit) if is_stable_over(at, ranges) else None


def parameters_at(
    axis: ContinuousAxis, law: CompliantLaw, values: Mapping[str, Fraction]
) -> tuple[CompliantLaw, Place, Any]:
    """Return law and motor at parameters, and what makes polynomials affine in all of them.

    Values are by name, ``Km``, ``tau`` or a gain; the others are as given.
    """
    nominal = axis.places[0].motor
    gain, tau = values.get("Km", nominal.gain), values.get("tau", nominal.time_constant)
    place = Place(replace(nominal, gain=gain, time_constant=tau))
    gains = {name: values.get(name, given) for name, given in law.gains.items()}
    own = gains.get("Mt") or gains.get("Bt") or ONE  # Only an admittance divides by one.
    return law.of(gains), place, as_fmpq(tau * own)


def _poles_in_the_air(law: CompliantLaw, free: Polynomial) -> Polynomial:
    """Leave out the pole at zero that a deflection is where nothing, no spring either, draws it."""
    if law.gains.get("Kt"):
        return free
    if free[0]:
        raise InternalError("the deflection in free motion has no pole at zero")
    return free.right_shift(1)


def over_admittance(law: CompliantLaw, low_pass: LowPass | None) -> Polynomial:
    """Return ``1/(H Y)``, times s with a spring."""
    gains = law.gains
    spring = [gains["Kt"]] if gains.get("Kt") else []
    law_alone = polynomial(gains["Mt"], gains["Bt"], *spring)
    if low_pass is None:
        return law_alone
    return law_alone * polynomial(1 / low_pass.pole, ONE) ** low_pass.order


def largest_over(
    at: Response,
    ranges: Mapping[str, Interval],
    band: Band,
    limit: Fraction | None,
) -> LargestResponse:
    """Bound a response over a band in rad/s and a box of parameters; it is affine in each."""
    low, high = (omega**2 for omega in band)
    found = Squares.of(at, ranges).largest(
        FrequencyPiece(low, high), limit=None if limit is None else limit**2
    )
    *places, x = found.at
    square = low + x * (high - low)
    return LargestResponse(
        above=None if found.above is None else root_below(found.above, _DIGITS) + _ABOVE,
        below=root_below(found.below, _DIGITS),
        square=square,
        at={
            name: r.low + u * (r.high - r.low)
            for (name, r), u in zip(ranges.items(), places, strict=True)
        },
        omega=float(square) ** 0.5,
    )


def root_below(x: Fraction, digits: int = 6) -> Fraction:
    """Return a number of so many decimals whose square is not above x."""
    return Fraction(isqrt(int(x * 10 ** (2 * digits))), 10**digits)
