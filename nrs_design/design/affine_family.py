"""Polynomials that are affine in each of several unknown but constant parameters.

Squares of their magnitudes on the imaginary axis have Bernstein forms over a box of parameters and
a range of ``omega^2``, which `nrs_design.design.largest_ratio` bounds.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from math import prod
from typing import Any, NamedTuple

from nrs_design.design.largest_ratio import MOST, bernstein, largest_ratio
from nrs_design.errors import InternalError
from nrs_design.models.interval import Interval
from nrs_design.proof.matrix import RationalMatrix
from nrs_design.proof.mode import Time
from nrs_design.proof.spectrum import is_stable

ZERO, ONE = Fraction(0), Fraction(1)
# Between low and high frequencies, (rad/s)^2, where all of them are looked at.
MIDDLE = Fraction(100)

Polynomial = Sequence[Fraction]  # Highest power first


class Quotient(NamedTuple):
    """A response at fixed parameters, as polynomials in s."""

    above: Polynomial
    below: Polynomial
    poles: Polynomial  # Whose roots are the poles of what is closed


def is_stable_over(
    at: Callable[[Mapping[str, Fraction]], Quotient],
    ranges: Mapping[str, Interval],
    most: int = MOST,
) -> bool:
    """Tell whether the poles of a response are shown to be on the left in a whole box.

    At most so many Bernstein coefficients are looked at.
    """
    poles = [lowest_first(corner.poles) for corner in corners_in(at, ranges)]
    return _is_stable(poles, most)


def corners_in(
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


def _is_stable(poles: Sequence[list[Fraction]], most: int) -> bool:
    """Tell whether polynomials, and all means of them, are shown to have their roots on the left.

    The polynomials are those at the corners of a box in which they are affine in each parameter.
    Where none has a root on the imaginary axis, nor at infinity, all have as many on the left as
    those at the corners.
    """
    if not all(map(_is_hurwitz, poles)):
        return False
    square, parameters = squared_over(poles), len(poles).bit_length() - 1
    for powers, end in ((square, MIDDLE), ([p[::-1] for p in square], 1 / MIDDLE)):
        below = coefficients_between(powers, ZERO, end)
        above = [ONE] * len(below)
        shape = (3,) * parameters + (len(powers[0]),)
        if largest_ratio(above, below, shape, nearly=None, most=most).above is None:
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


def lowest_first(P: Polynomial) -> list[Fraction]:
    """Return a polynomial the other way round."""
    return list(reversed(P))


def zeros_at_rest(P: Sequence[Fraction]) -> int:
    """Return by which power of s a polynomial, lowest power first, can be divided."""
    return next((i for i, c in enumerate(P) if c), len(P))


def squared_over(
    corners: Sequence[Sequence[Fraction]],
    square: Callable[[Sequence[Any]], list[Any]] | None = None,
) -> list[list[Any]]:
    """Return ``|P(j omega)|^2`` in omega^2, in Bernstein form in every parameter, for Flint.

    P is affine in each parameter; its corners come with the last parameter turning fastest, lowest
    power first. `square` takes the place of ``|P(j omega)|^2`` as what is of second degree in P.
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


def coefficients_between(
    powers: Sequence[Sequence[Any]], low: Fraction, high: Fraction
) -> list[Any]:
    """Return Bernstein coefficients in omega^2 too, between two values of it, in (rad/s)^2."""
    ends = _fmpq(low), _fmpq(high)
    return [c for p in powers for c in bernstein(p, *ends)]


def _fmpq(number: Fraction) -> Any:
    from flint import fmpq

    return fmpq(number.numerator, number.denominator)
