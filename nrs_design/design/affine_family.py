"""Polynomials that are affine in each of several unknown but constant parameters.

Squares of their magnitudes on the imaginary axis have Bernstein forms over a box of parameters and
a range of ``omega^2``, which `nrs_design.design.largest_ratio` bounds. In a box they are given by
those at its corners, the last parameter turning fastest. Polynomials are those of flint, exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any, NamedTuple, Self

from nrs_design.design.largest_ratio import bernstein, bound_ratio
from nrs_design.errors import InternalError
from nrs_design.loop.cut_loop import ContinuousAxis, Place
from nrs_design.loop.hull import rational
from nrs_design.models.interval import Interval
from nrs_design.proof.exact import is_hurwitz_polynomial

ZERO, ONE = Fraction(0), Fraction(1)

Polynomial = Any  # A `flint.fmpq_poly`
Square = Callable[..., Polynomial]  # A function of polynomials, of second degree in them
# From parameters to numerator and denominator, or to a characteristic polynomial alone.
Response = Callable[[Mapping[str, Fraction]], tuple[Polynomial, ...]]


class FrequencyPiece(NamedTuple):
    """A piece of the frequencies, in (rad/s)^2."""

    low: Fraction
    high: Fraction
    inverse: bool = False  # The piece is in the inverse of the squared frequency


def everywhere(middle: Fraction = Fraction(100)) -> tuple[FrequencyPiece, FrequencyPiece]:
    """Return all frequencies, in two pieces."""
    return FrequencyPiece(ZERO, middle), FrequencyPiece(ZERO, 1 / middle, inverse=True)


def corners_in(response: Response, ranges: Mapping[str, Interval]) -> list[tuple[Polynomial, ...]]:
    """Return a response at the corners of a box, of which it is a mean at a point inside."""
    ends = [*product((0, 1), repeat=len(ranges))]
    corners = [
        response(
            {name: (r.low, r.high)[k] for k, (name, r) in zip(end, ranges.items(), strict=True)}
        )
        for end in ends
    ]
    # In the middle an odd error would cancel.
    shares = [Fraction(1, i + 3) for i in range(len(ranges))]
    interior = response(
        {n: r.low + u * (r.high - r.low) for u, (n, r) in zip(shares, ranges.items(), strict=True)}
    )
    weights = [
        rational(prod((u if k else 1 - u for k, u in zip(end, shares, strict=True)), start=ONE))
        for end in ends
    ]
    for found, *corner_parts in zip(interior, *corners, strict=True):
        if found != sum(w * p for w, p in zip(weights, corner_parts, strict=True)):
            raise InternalError("a response is not affine in the parameters of its loop")
    return corners


def is_stable_over(poles: Response, ranges: Mapping[str, Interval]) -> bool:
    """Tell whether a polynomial is shown to be Hurwitz in a whole box.

    Where no polynomial has a root on the imaginary axis or at infinity, all are as at the corners.
    """
    corners = corners_in(poles, ranges)
    if len({P.degree() for (P,) in corners}) > 1 or not all(_is_hurwitz(P) for (P,) in corners):
        return False
    return Squares(corners).vanish_nowhere(everywhere())


def _is_hurwitz(P: Polynomial) -> bool:
    """Tell whether the roots of a polynomial are on the left."""
    return is_hurwitz_polynomial([int(c) for c in reversed(P.numer().coeffs())])


class Squares:
    """Polynomials in ``omega^2`` that are nowhere negative, over a box, alone or as a quotient."""

    def __init__(
        self,
        denominators: Sequence[tuple[Polynomial, ...]],
        numerators: Sequence[tuple[Polynomial, ...]] | None = None,
        square: Square | None = None,
    ) -> None:
        """Square denominators at the corners, and numerators; without these, one."""
        sides = [side for side in (denominators, numerators) if side is not None]
        self._grids = [squared_over(side, square) for side in sides]
        self._size = max(len(p) for grid in self._grids for p in grid)
        self._parameters = len(denominators).bit_length() - 1

    @classmethod
    def of(cls, response: Response, ranges: Mapping[str, Interval]) -> Self:
        """Return the square of a response over a box."""
        corners = corners_in(response, ranges)
        # Powers of s that all polynomials have cancel.
        zeros = min(zeros_at_rest(p) for corner in corners for p in corner)
        numerators, denominators = (
            [(corner[i].right_shift(zeros),) for corner in corners] for i in (0, 1)
        )
        return cls(denominators, numerators)

    def bound(self, piece: FrequencyPiece, limit: Fraction | None = None) -> Fraction | None:
        """Return a bound on the quotient in the box and in a piece of the frequencies.

        The search ends below the limit, if any; None without a bound.
        """
        sides = [self._interpolate(grid, piece) for grid in self._grids]
        below, above = sides if len(sides) == 2 else (sides[0], [ONE] * len(sides[0]))
        return bound_ratio(above, below, (3,) * self._parameters + (self._size,), limit)

    def stay_below(self, limit: Fraction, pieces: Sequence[FrequencyPiece]) -> bool:
        """Tell whether the quotient is shown to be nowhere above a limit."""
        found = (self.bound(piece, limit) for piece in pieces)
        return all(bound is not None and bound <= limit for bound in found)

    def vanish_nowhere(self, pieces: Sequence[FrequencyPiece]) -> bool:
        """Tell whether the denominators are shown to vanish nowhere."""
        return all(self.bound(piece) is not None for piece in pieces)

    def _interpolate(self, grid: Sequence[Polynomial], piece: FrequencyPiece) -> list[Any]:
        """Return Bernstein coefficients in omega^2 too."""
        ends = rational(piece.low), rational(piece.high)
        full = ([p[i] for i in range(self._size)] for p in grid)
        return [c for p in full for c in bernstein(p[::-1] if piece.inverse else p, *ends)]


def zeros_at_rest(P: Polynomial) -> int:
    """Return by which power of its variable a polynomial can be divided."""
    return next((i for i, c in enumerate(P.coeffs()) if c), len(P))


def squared_over(
    corners: Sequence[tuple[Polynomial, ...]], square: Square | None = None
) -> list[Polynomial]:
    """Return a square of polynomials in Bernstein form in every parameter.

    They are affine in each parameter; by default it is ``|P(j omega)|^2`` in omega^2, of one.
    """
    count = len(corners).bit_length() - 1
    grid = dict(zip(product((0, 2), repeat=count), corners, strict=True))
    for axis in range(count):
        for at in [index for index in grid if index[axis] == 0]:
            ends = zip(grid[at], grid[(*at[:axis], 2, *at[axis + 1 :])], strict=True)
            grid[(*at[:axis], 1, *at[axis + 1 :])] = tuple((a + b) / 2 for a, b in ends)
    squares = {at: (square or squared_magnitude)(*grid[at]) for at in sorted(grid)}
    for axis in range(count):
        for at in [at for at in squares if at[axis] == 1]:
            low, high = (squares[(*at[:axis], end, *at[axis + 1 :])] for end in (0, 2))
            squares[at] = 2 * squares[at] - (low + high) / 2
    return list(squares.values())


def squared_magnitude(P: Polynomial) -> Polynomial:
    """Return ``|P(j omega)|^2`` in omega^2."""
    return real_product(P, P)


def real_product(P: Polynomial, Q: Polynomial) -> Polynomial:
    """Return ``Re P(j omega) conj(Q(j omega))`` in omega^2."""
    (a, b), (c, d) = parts_on_axis(P), parts_on_axis(Q)
    return a * c + (b * d).left_shift(1)


def parts_on_axis(P: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Return both parts of ``P(j omega) = R(omega^2) + j omega I(omega^2)``."""
    from flint import fmpq_poly

    real, imaginary = (
        fmpq_poly([c * (-1) ** k for k, c in enumerate(P.coeffs()[first::2])]) for first in (0, 1)
    )
    return real, imaginary


def polynomial(*coefficients: Fraction) -> Polynomial:
    """Return the polynomial with some coefficients, the highest power first."""
    from flint import fmpq_poly

    return fmpq_poly([rational(c) for c in reversed(coefficients)])


def find_motor(axis: ContinuousAxis, values: Mapping[str, Fraction]) -> tuple[Place, Any]:
    """Return the motor at parameters, and the factor that makes polynomials affine in them.

    Values are by name, ``Km`` or ``tau``; those that are not given are nominal.
    """
    nominal = axis.places[0].motor
    gain, tau = values.get("Km", nominal.gain), values.get("tau", nominal.time_constant)
    return Place(replace(nominal, gain=gain, time_constant=tau)), rational(tau)
