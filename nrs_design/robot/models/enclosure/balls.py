"""Arrays of balls: what a number is, up to a radius, for many boxes at once.

flint's balls hold one number each; a workspace takes some ten thousand boxes, with a hundred
thousand operations each. These are pairs of arrays in double precision. Every operation adds to the
radius what it may round, so the result for any numbers in the operands is in the result.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Half the distance from 1 to the next float; what is too small for a normal float is off by less
# than the second.
UNIT = 2.0**-53
TINY = 2.0**-1000
# A radius is a sum of at most eight terms that are not negative, each rounded a few times.
OUTWARD = 1.0 + 32 * UNIT


class Balls:
    """Midpoints and radii, of shapes that broadcast.

    Parameters
    ----------
    mid, rad : array
        A radius that is not finite stands for no knowledge at all.
    """

    __slots__ = ("mid", "rad")
    # NumPy shall not take these for numbers.
    __array_ufunc__ = None

    def __init__(self, mid: Any, rad: Any = 0.0) -> None:
        self.mid = mid
        self.rad = rad

    def __add__(self, other: Balls | float) -> Balls:
        """Return the sum."""
        if not isinstance(other, Balls):
            other = Balls(other)
        mid = self.mid + other.mid
        return Balls(mid, (self.rad + other.rad + UNIT * abs(mid)) * OUTWARD)

    def __neg__(self) -> Balls:
        """Return the opposite."""
        return Balls(-self.mid, self.rad)

    def __sub__(self, other: Balls | float) -> Balls:
        """Return the difference."""
        return self + (-other)

    def __rsub__(self, other: float) -> Balls:
        """Return the difference to a number."""
        return -self + other

    def __mul__(self, other: Balls | float) -> Balls:
        """Return the product."""
        if not isinstance(other, Balls):
            other = Balls(other)
        mid = self.mid * other.mid
        rad = abs(self.mid) * other.rad + self.rad * (abs(other.mid) + other.rad)
        return Balls(mid, (rad + UNIT * abs(mid)) * OUTWARD + TINY)

    __radd__ = __add__
    __rmul__ = __mul__

    @property
    def magnitude(self) -> Any:
        """Not below the magnitude of any number in the ball."""
        return (abs(self.mid) + self.rad) * OUTWARD

    def reciprocal(self) -> Balls:
        """Return one over it; where zero is in a ball, its radius is not finite."""
        size = abs(self.mid)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            mid = 1.0 / self.mid
            # The distance from zero, rounded towards it.
            gap = size * (1 - 4 * UNIT) - self.rad
            # One after the other: their product may leave the floats.
            rad = np.where(gap > 0, self.rad / size / gap, np.inf)
        return Balls(mid, (rad + UNIT * abs(mid)) * OUTWARD + TINY)

    def sqrt(self) -> Balls:
        """Return the root; where a ball holds what is not above zero, its radius is not finite."""
        with np.errstate(divide="ignore", invalid="ignore"):
            mid = np.sqrt(self.mid)
            low = self.mid * (1 - 4 * UNIT) - self.rad
            rad = np.where(low > 0, self.rad / (mid * (1 - 4 * UNIT)), np.inf)
        return Balls(mid, (rad + UNIT * mid) * OUTWARD + TINY)
