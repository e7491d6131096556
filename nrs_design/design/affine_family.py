"""Polynomials that are affine in each of several unknown but constant parameters.

Squares of their magnitudes on the imaginary axis have Bernstein forms over a box of parameters and
a range of ``omega^2``, which `nrs_design.design.largest_ratio` bounds. In a box they are given by
those at its corners, the last parameter turning fastest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any, NamedTuple, Self

from nrs_design.design.largest_ratio import MOST, LargestRatio, bernstein, largest_ratio
from nrs_design.errors import InternalError
from nrs_design.models.interval import Interval
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable

ZERO, ONE = Fraction(0), Fraction(1)

Polynomial = Sequence[Fraction]  # Highest power first
# Of what is of second degree in polynomials, lowest power first: a polynomial again.
Square = Callable[[Sequence[Any]], list[Any]]


class FrequencyPiece(NamedTuple):
    """A piece of the frequencies, in (rad/s)^2."""

    low: Fraction
    high: Fraction
    inverse: bool = False  # Whether it is of one over the frequencies


def everywhere(middle: Fraction = Fraction(100)) -> tuple[FrequencyPiece, FrequencyPiece]:
    """Return all frequencies: those up to one, and those from it on."""
    return FrequencyPiece(ZERO, middle), FrequencyPiece(ZERO, 1 / middle, inverse=True)


class Quotient(NamedTuple):
    """A response at fixed parameters, as polynomials in s."""

    above: Polynomial
    below: Polynomial
    poles: Polynomial  # Whose roots are the poles of what is closed


Response = Callable[[Mapping[str, Fraction]], Quotient]


def corners_in(at: Response, ranges: Mapping[str, Interval]) -> list[Quotient]:
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


def is_stable_over(at: Response, ranges: Mapping[str, Interval], most: int = MOST) -> bool:
    """Tell whether the poles of a response are shown to be on the left in a whole box.

    At most so many Bernstein coefficients are looked at. Where none of the polynomials has a root
    on the imaginary axis, nor at infinity, all have as many on the left as those at the corners.
    """
    poles = [lowest_first(corner.poles) for corner in corners_in(at, ranges)]
    return all(map(_is_hurwitz, poles)) and Squares(poles).vanish_nowhere(everywhere(), most)


def _is_hurwitz(P: Sequence[Fraction]) -> bool:
    """Tell whether the roots of a polynomial, lowest power first, are on the left."""
    *rest, leading = P
    if not leading:
        return False
    n = len(rest)
    rows = [[ONE * (j == i + 1) for j in range(n)] for i in range(n - 1)]
    rows += [[-c / leading for c in rest]] * (n > 0)
    return not rows or is_stable(RationalMatrix.from_rows(rows), Time.CONTINUOUS)


class Squares:
    """Squares of polynomials over a box, alone or as a quotient."""

    def __init__(
        self,
        below: Sequence[Sequence[Fraction]],
        above: Sequence[Sequence[Fraction]] | None = None,
        square: Square | None = None,
    ) -> None:
        """Take polynomials at the corners, lowest power first; one is above if nothing is given."""
        sides = [side for side in (below, above) if side is not None]
        # In a quotient, powers of s that all of them have cancel.
        rest = 0 if above is None else min(zeros_at_rest(p) for side in sides for p in side)
        self._grids = [squared_over([p[rest:] for p in side], square) for side in sides]
        self._size = max(len(p) for grid in self._grids for p in grid)
        self._parameters = len(below).bit_length() - 1

    @classmethod
    def of(cls, at: Response, ranges: Mapping[str, Interval]) -> Self:
        """Return the square of a response over a box."""
        corners = corners_in(at, ranges)
        above, below = ([lowest_first(corner[i]) for corner in corners] for i in (0, 1))
        return cls(below, above)

    def largest(self, piece: FrequencyPiece, **search: Any) -> LargestRatio:
        """Bound the largest quotient over the box and a piece of the frequencies."""
        sides = [self._between(grid, piece) for grid in self._grids]
        below, above = sides if len(sides) == 2 else (sides[0], [ONE] * len(sides[0]))
        return largest_ratio(above, below, (3,) * self._parameters + (self._size,), **search)

    def stay_below(self, limit: Fraction, pieces: Sequence[FrequencyPiece], most: int) -> bool:
        """Tell whether the quotient is shown to be nowhere above a limit."""
        found = (self.largest(p, limit=limit, nearly=None, most=most).above for p in pieces)
        return all(above is not None and above <= limit for above in found)

    def vanish_nowhere(self, pieces: Sequence[FrequencyPiece], most: int) -> bool:
        """Tell whether the squares, which nothing is above, are shown to be nowhere zero."""
        found = (self.largest(piece, nearly=None, most=most) for piece in pieces)
        return all(one.above is not None for one in found)

    def _between(self, grid: Sequence[Sequence[Any]], piece: FrequencyPiece) -> list[Any]:
        """Return Bernstein coefficients in omega^2 too."""
        ends = _fmpq(piece.low), _fmpq(piece.high)
        full = ([*p, *[0] * (self._size - len(p))] for p in grid)
        return [c for p in full for c in bernstein(p[::-1] if piece.inverse else p, *ends)]


def lowest_first(P: Polynomial) -> list[Fraction]:
    """Return a polynomial the other way round."""
    return list(reversed(P))


def minus(P: Polynomial, Q: Polynomial) -> list[Fraction]:
    """Return a difference of polynomials, highest power first."""
    size = max(len(P), len(Q))
    first, second = ([ZERO] * (size - len(p)) + [*p] for p in (P, Q))
    return [a - b for a, b in zip(first, second, strict=True)]


def zeros_at_rest(P: Sequence[Fraction]) -> int:
    """Return by which power of s a polynomial, lowest power first, can be divided."""
    return next((i for i, c in enumerate(P) if c), len(P))


def squared_over(
    corners: Sequence[Sequence[Fraction]], square: Square | None = None
) -> list[list[Any]]:
    """Return ``|P(j omega)|^2`` in omega^2, in Bernstein form in every parameter, for Flint.

    P is affine in each parameter, lowest power first at the corners. `square` takes the place of
    ``|P(j omega)|^2`` as what is of second degree in P.
    """
    count = len(corners).bit_length() - 1
    exact = ([_fmpq(c) for c in p] for p in corners)
    grid = dict(zip(product((0, 2), repeat=count), exact, strict=True))
    for axis in range(count):
        for at in [at for at in grid if at[axis] == 0]:
            ends = grid[at], grid[(*at[:axis], 2, *at[axis + 1 :])]
            middle = [(a + b) / 2 for a, b in zip(*ends, strict=True)]
            grid[(*at[:axis], 1, *at[axis + 1 :])] = middle
    squares = {at: (square or squared_magnitude)(grid[at]) for at in sorted(grid)}
    for axis in range(count):
        for at in [at for at in squares if at[axis] == 1]:
            low, high = (squares[(*at[:axis], end, *at[axis + 1 :])] for end in (0, 2))
            triples = zip(squares[at], low, high, strict=True)
            squares[at] = [2 * m - (a + b) / 2 for m, a, b in triples]
    return list(squares.values())


def squared_magnitude(P: Sequence[Any]) -> list[Any]:
    """Return ``|P(j omega)|^2`` in omega^2, lowest powers first."""
    return real_product(P, P)


def real_product(P: Sequence[Any], Q: Sequence[Any]) -> list[Any]:
    """Return ``Re P(j omega) conj(Q(j omega))`` in omega^2, lowest powers first."""
    found = [_fmpq(ZERO)] * len(P)
    for i, a in enumerate(P):
        for k, b in enumerate(Q):
            # Odd powers of j cancel: of i + k odd there is nothing.
            if (i + k) % 2 == 0:
                found[(i + k) // 2] += (-1) ** (abs(i - k) // 2) * a * b
    return found


def _fmpq(number: Fraction) -> Any:
    from flint import fmpq

    return fmpq(number.numerator, number.denominator)
