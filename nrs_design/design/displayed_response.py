"""What the surgeon feels and how well the tool follows, bounded over a band and all ranges.

The **displayed impedance** ``Z = F/V`` is the force of the hand over the velocity of the tool, in
free motion: ``Z = D/N``, with the characteristic polynomial D of the assembled mode that touches
nothing and ``D + b N`` that with a damper b, as in `nrs_design.design.passivity`. The **tracking
error** is ``|1 - V/Vcmd|`` of a commanded velocity. With the part M of N that passes the law,
``M/D = G H Y``, so V/Vcmd is ``M/(H Y)`` over D in free motion, and over the characteristic
polynomial of the mode in contact else.

Times Mt (or Bt without inertia) and the time constant, all of these are affine in each of Km, tau,
Mt, Bt, Kt, and k and b of the contact; so the squares of the magnitudes are polynomials in omega^2
and of second degree in each parameter, and `nrs_design.proof.largest_ratio` bounds their quotient.
Each parameter is unknown but constant: that is what a frequency response is about.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from math import comb, prod
from typing import Any, NamedTuple

from nrs_design.controllers.laws import Admittance, CompliantLaw
from nrs_design.controllers.sensor import LowPass
from nrs_design.design.passivity import root_below
from nrs_design.errors import InternalError
from nrs_design.models.contact import KelvinVoigt
from nrs_design.models.interval import Interval
from nrs_design.proof.largest_ratio import bernstein, largest_ratio
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable
from nrs_design.switched.cut_loop import ContinuousAxis, Place, multiply

ZERO, ONE = Fraction(0), Fraction(1)
# Between low and high frequencies, (rad/s)^2, where all of them are looked at.
_MIDDLE = Fraction(100)
# Digits of a root.
_DIGITS = 20

Polynomial = Sequence[Fraction]  # Highest power first
Band = tuple[Fraction, Fraction]  # In rad/s


class Quotient(NamedTuple):
    """A response at fixed parameters, as polynomials in s."""

    above: Polynomial
    below: Polynomial
    poles: Polynomial  # Whose roots are the poles of what is closed


@dataclass(frozen=True, slots=True)
class LargestResponse:
    """Two bounds on the largest magnitude over a band and ranges."""

    # No parameters in their ranges and no frequency in the band give more; None if not shown.
    above: Fraction | None
    below: Fraction  # At one point there is at least this
    square: Fraction  # Of the frequency there in rad/s; sampled, of tan(omega T/2); exactly
    at: Mapping[str, Fraction]  # The parameters there, exactly
    omega: float  # The frequency in rad/s, for people


def largest_impedance(
    axis: ContinuousAxis,
    law: CompliantLaw,
    ranges: Mapping[str, Interval],
    band: Band,
    limit: Fraction | None = None,
) -> LargestResponse | None:
    """Bound the largest displayed impedance, in N m s/rad.

    Parameters
    ----------
    axis : ContinuousAxis
        From which the modes follow.
    law : CompliantLaw
        An admittance with its gains.
    ranges : mapping of str to Interval
        Where ``Km``, ``tau`` of the motor and ``Mt``, ``Bt``, ``Kt`` are, if they have ranges.
    band : tuple of Fraction
        Lowest and highest frequency, rad/s.
    limit : Fraction, optional
        What it should stay below.

    Returns
    -------
    LargestResponse or None
        None where the robot that nobody holds is not shown to be stable.
    """

    def at(values: Mapping[str, Fraction]) -> Quotient:
        held, place, factor = _at(axis, law, values)
        free, damped = (
            [factor * c for c in axis.cut(held, KelvinVoigt(ZERO, b), place).closed]
            for b in (ZERO, ONE)
        )
        felt = [b - a for a, b in zip(free, damped, strict=True)]
        return Quotient(free, felt, _poles_in_the_air(held, free))

    return largest_over(at, ranges, band, limit) if is_stable_over(at, ranges) else None


def largest_tracking_error(
    axis: ContinuousAxis,
    law: CompliantLaw,
    ranges: Mapping[str, Interval],
    band: Band,
    limit: Fraction | None = None,
    *,
    in_contact: bool = False,
) -> LargestResponse | None:
    """Bound the largest ``|1 - V/Vcmd|``, a share of the commanded velocity.

    Parameters
    ----------
    axis, law, band, limit
        As for `largest_impedance`.
    ranges : mapping of str to Interval
        As for `largest_impedance`, and ``k`` and ``b`` of what is touched.
    in_contact : bool
        Whether something is touched; in free motion the law has no part in it.

    Returns
    -------
    LargestResponse or None
        None where the loop is not shown to be stable.
    """
    if not in_contact:
        # Any law will do: the simplest.
        axis, law = replace(axis, low_pass=None), Admittance(ZERO, ONE)
        ranges = {name: r for name, r in ranges.items() if name in ("Km", "tau")}

    def at(values: Mapping[str, Fraction]) -> Quotient:
        held, place, factor = _at(axis, law, values)
        damped = axis.cut(held, KelvinVoigt(ZERO, ONE), place)
        touched = KelvinVoigt(values.get("k", ZERO), values.get("b", ZERO))
        closed = [factor * c for c in axis.cut(held, touched, place).closed]
        passed = [b - a for a, b in zip(damped.opened, damped.closed, strict=True)]
        driven = multiply([factor * c for c in passed], _over_admittance(held, axis.low_pass))
        # The spring of the law is one over s.
        below = multiply(closed, [ONE, ZERO]) if held.gains.get("Kt") else closed
        poles = closed if in_contact else _poles_in_the_air(held, closed)
        return Quotient(_subtracted(below, driven), below, poles)

    return largest_over(at, ranges, band, limit) if is_stable_over(at, ranges) else None


def _at(
    axis: ContinuousAxis, law: CompliantLaw, values: Mapping[str, Fraction]
) -> tuple[CompliantLaw, Place, Fraction]:
    """Return law and motor at parameters, and what makes polynomials affine in all of them."""
    nominal = axis.places[0].motor
    gain, tau = values.get("Km", nominal.gain), values.get("tau", nominal.time_constant)
    place = Place(replace(nominal, gain=gain, time_constant=tau))
    gains = {name: values.get(name, given) for name, given in law.gains.items()}
    return law.of(gains), place, tau * (gains["Mt"] or gains["Bt"])


def _poles_in_the_air(law: CompliantLaw, free: Polynomial) -> Polynomial:
    """Leave out the pole at zero that a deflection is where nothing, no spring either, draws it."""
    *poles, last = free
    if law.gains.get("Kt"):
        return free
    if last:
        raise InternalError("the deflection in free motion has no pole at zero")
    return poles


def _over_admittance(law: CompliantLaw, low_pass: LowPass | None) -> Polynomial:
    """Return ``1/(H Y)``, times s with a spring."""
    gains = law.gains
    rows = [gains["Mt"], gains["Bt"], *([gains["Kt"]] if gains.get("Kt") else [])]
    if low_pass is None:
        return rows
    n, lag = low_pass.order, 1 / low_pass.pole
    return multiply(rows, [lag**k * comb(n, k) for k in range(n, -1, -1)])


def _subtracted(P: Polynomial, Q: Polynomial) -> list[Fraction]:
    size = max(len(P), len(Q))
    first, second = ([ZERO] * (size - len(p)) + [*p] for p in (P, Q))
    return [a - b for a, b in zip(first, second, strict=True)]


def largest_over(
    at: Callable[[Mapping[str, Fraction]], Quotient],
    ranges: Mapping[str, Interval],
    band: Band,
    limit: Fraction | None,
) -> LargestResponse:
    """Bound a response over a band and a box of parameters.

    Parameters
    ----------
    at : callable
        Gives the response at parameters; its polynomials are affine in each of them.
    ranges : mapping of str to Interval
        The box.
    band, limit
        As for `largest_impedance`.
    """
    corners = _corners(at, ranges)
    above = [_lowest_first(corner.above) for corner in corners]
    below = [_lowest_first(corner.below) for corner in corners]
    shared = min(map(_zeros, (*above, *below)))
    above, below = ([p[shared:] for p in each] for each in (above, below))
    tensors = [_squared(each) for each in (above, below)]
    size = max(len(grid[0]) for grid in tensors)
    low, high = (omega**2 for omega in band)
    numerator, denominator = (
        _coefficients([[*p, *[0] * (size - len(p))] for p in grid], low, high) for grid in tensors
    )
    found = largest_ratio(
        numerator,
        denominator,
        (3,) * len(ranges) + (size,),
        limit=None if limit is None else limit**2,
    )
    *places, x = found.at
    square = low + x * (high - low)
    return LargestResponse(
        above=None if found.above is None else root_above(found.above),
        below=root_below(found.below, _DIGITS),
        square=square,
        at={
            name: r.low + u * (r.high - r.low)
            for (name, r), u in zip(ranges.items(), places, strict=True)
        },
        omega=float(square) ** 0.5,
    )


def is_stable_over(
    at: Callable[[Mapping[str, Fraction]], Quotient], ranges: Mapping[str, Interval]
) -> bool:
    """Tell whether the poles of a response are shown to be on the left in a whole box.

    Parameters
    ----------
    at, ranges
        As for `largest_over`.
    """
    poles = [_lowest_first(corner.poles) for corner in _corners(at, ranges)]
    return _is_stable(poles)


def _corners(
    at: Callable[[Mapping[str, Fraction]], Quotient], ranges: Mapping[str, Interval]
) -> list[Quotient]:
    """Return a response at the corners of a box, of which it is a mean at a point inside."""
    ends = [*product((0, 1), repeat=len(ranges))]
    corners = [
        at({name: (r.low, r.high)[k] for k, (name, r) in zip(end, ranges.items(), strict=True)})
        for end in ends
    ]
    # Not the middle, where what is odd about it would not be seen.
    shares = [Fraction(1, i + 3) for i in range(len(ranges))]
    inside = at(
        {n: r.low + u * (r.high - r.low) for u, (n, r) in zip(shares, ranges.items(), strict=True)}
    )
    weights = [prod(u if k else 1 - u for k, u in zip(end, shares, strict=True)) for end in ends]
    for i, found in enumerate(inside):
        for k, c in enumerate(found):
            if c != sum(w * corner[i][k] for w, corner in zip(weights, corners, strict=True)):
                raise InternalError("a response is not affine in the parameters of its loop")
    return corners


def _is_stable(poles: Sequence[list[Fraction]]) -> bool:
    """Tell whether polynomials, and all means of them, are shown to have their roots on the left.

    The polynomials are those at the corners of a box in which they are affine in each parameter.
    Where none has a root on the imaginary axis, nor at infinity, all have as many on the left as
    those at the corners.
    """
    if not all(map(_is_hurwitz, poles)):
        return False
    square, parameters = _squared(poles), len(poles).bit_length() - 1
    for powers, end in ((square, _MIDDLE), ([p[::-1] for p in square], 1 / _MIDDLE)):
        below = _coefficients(powers, ZERO, end)
        above = [ONE] * len(below)
        shape = (3,) * parameters + (len(powers[0]),)
        if largest_ratio(above, below, shape, nearly=None).above is None:
            return False
    return True


def _is_hurwitz(P: Sequence[Fraction]) -> bool:
    """Tell whether the roots of a polynomial, lowest power first, are on the left."""
    *rest, leading = P
    if not leading:
        return False
    n = len(rest)
    rows = [[ONE * (j == i + 1) for j in range(n)] for i in range(n - 1)]
    rows += [[-c / leading for c in rest]] * (n > 0)
    return not rows or is_stable(RationalMatrix.from_rows(rows), Time.CONTINUOUS)


def _lowest_first(P: Polynomial) -> list[Fraction]:
    return list(reversed(P))


def _zeros(P: Sequence[Fraction]) -> int:
    """Return by which power of s a polynomial, lowest power first, can be divided."""
    return next((i for i, c in enumerate(P) if c), len(P))


def _squared(corners: Sequence[Sequence[Fraction]]) -> list[list[Any]]:
    """Return ``|P(j omega)|^2`` in omega^2, in Bernstein form in every parameter.

    Parameters
    ----------
    corners : sequence of sequence of Fraction
        P at the corners of the box, the last parameter turning fastest; lowest power first. It is
        affine in each parameter.

    Returns
    -------
    list of list of fmpq
        Flint's rational numbers, which take a tenth of the time of Python's.
    """
    count = len(corners).bit_length() - 1
    exact = ([_fmpq(c) for c in p] for p in corners)
    grid = dict(zip(product((0, 2), repeat=count), exact, strict=True))
    for axis in range(count):
        for at in [at for at in grid if at[axis] == 0]:
            ends = grid[at], grid[(*at[:axis], 2, *at[axis + 1 :])]
            middle = [(a + b) / 2 for a, b in zip(*ends, strict=True)]
            grid[(*at[:axis], 1, *at[axis + 1 :])] = middle
    squares = {at: _magnitude(grid[at]) for at in sorted(grid)}
    for axis in range(count):
        for at in [at for at in squares if at[axis] == 1]:
            low, high = (squares[(*at[:axis], end, *at[axis + 1 :])] for end in (0, 2))
            triples = zip(squares[at], low, high, strict=True)
            squares[at] = [2 * m - (a + b) / 2 for m, a, b in triples]
    return list(squares.values())


def _magnitude(P: Sequence[Any]) -> list[Any]:
    """Return ``|P(j omega)|^2`` in omega^2, lowest powers first."""
    square = [_fmpq(ZERO)] * len(P)
    for i, a in enumerate(P):
        for k, b in enumerate(P):
            # Odd powers of j cancel: of i + k odd there is nothing.
            if (i + k) % 2 == 0:
                square[(i + k) // 2] += (-1) ** (abs(i - k) // 2) * a * b
    return square


def _coefficients(powers: Sequence[Sequence[Any]], low: Fraction, high: Fraction) -> list[Any]:
    """Return Bernstein coefficients in omega^2 too, between two values of it."""
    ends = _fmpq(low), _fmpq(high)
    return [c for p in powers for c in bernstein(p, *ends)]


def _fmpq(number: Fraction) -> Any:
    from flint import fmpq

    return fmpq(number.numerator, number.denominator)


def root_above(square: Fraction) -> Fraction:
    """Return a number whose square is not below, near the root."""
    return root_below(square, _DIGITS) + Fraction(1, 10**_DIGITS)
