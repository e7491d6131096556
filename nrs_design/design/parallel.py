"""Where parallel position and force control is stable: exactly, and with dead time for the eye.

With the motion loop G = N/D from position command to position, ``1 + k (Kp + Ki/s) G = 0`` gives
``s D + k (Kp s + Ki) N``: stiffness and gains count by their products alone, so one map of k Kp and
k Ki holds for every stiffness, and a law is a ray from its origin.
"""

from __future__ import annotations

from fractions import Fraction
from math import isqrt

import numpy as np
from numpy.typing import NDArray

from nrs_design.design.transfer import TransferFunction
from nrs_design.models.motion_loop import MotionLoop

# Of the ends of an interval that are no rational numbers.
RESOLUTION = 10**6


def coefficients(loop: MotionLoop) -> tuple[Fraction, Fraction, Fraction, Fraction] | None:
    """Return a1, a0, b1, b0 of ``(b1 s + b0)/(s^2 + a1 s + a0)``; None for another order."""
    if len(loop.denominator) != 3 or len(loop.numerator) > 2:
        return None
    lead, a1, a0 = loop.denominator
    b1, b0 = (Fraction(0),) * (2 - len(loop.numerator)) + loop.numerator
    return a1 / lead, a0 / lead, b1 / lead, b0 / lead


def is_stable(loop: MotionLoop, proportional: Fraction, integral: Fraction) -> bool | None:
    """Decide with Routh's criterion; None for a motion loop that is not of second order.

    Parameters
    ----------
    loop : MotionLoop
        From position command to position.
    proportional, integral : Fraction
        ``k Kp`` without unit, and ``k Ki`` in 1/s.
    """
    found = coefficients(loop)
    if found is None:
        return None
    a1, a0, b1, b0 = found
    c2 = a1 + proportional * b1
    c1 = a0 + proportional * b0 + integral * b1
    c0 = integral * b0
    return c2 > 0 and c1 > 0 and c0 > 0 and c2 * c1 > c0


def unstable_stiffness(
    loop: MotionLoop, Kp: Fraction, Ki: Fraction
) -> tuple[Fraction, Fraction | None] | None:
    """Return which stiffness makes the loop unstable: an interval that contains all of it.

    Of Routh's conditions only ``c2 c1 > c0`` can fail where G is stable with positive
    coefficients. It is quadratic in k, positive at 0, so what fails is one interval at most.

    Parameters
    ----------
    loop : MotionLoop
        Of second order, with positive coefficients.
    Kp, Ki : Fraction
        Gains in rad/(N m) and rad/(N m s); not negative.

    Returns
    -------
    tuple or None
        Its ends in N m/rad, rounded away from it; None above for no end; None for no such
        stiffness.

    Raises
    ------
    ValueError
        If the motion loop is another one.
    """
    found = coefficients(loop)
    if found is None or min(found) < 0 or min(found[:2]) == 0:
        raise ValueError("the motion loop is not of second order with positive coefficients")
    a1, a0, b1, b0 = found
    slope = Kp * b0 + Ki * b1
    A, B, C = Kp * b1 * slope, a1 * slope + a0 * Kp * b1 - Ki * b0, a1 * a0
    if B >= 0:
        return None
    if A == 0:
        return C / -B, None
    square = B * B - 4 * A * C
    if square < 0:
        return None
    low, high = _root_between(square)
    return (-B - high) / (2 * A), (-B + high) / (2 * A) if low >= 0 else None


def _root_between(square: Fraction) -> tuple[Fraction, Fraction]:
    """Return two fractions around a square root, as near as the resolution."""
    scaled = square * RESOLUTION**2
    below = isqrt(scaled.numerator // scaled.denominator)
    return Fraction(below, RESOLUTION), Fraction(below + 1, RESOLUTION)


def border(
    motion: TransferFunction, delay: float, frequencies: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where a pair of poles crosses the imaginary axis, for the eye.

    Parameters
    ----------
    motion : TransferFunction
        G.
    delay : float
        Dead time of the force signal in s.
    frequencies : ndarray
        In rad/s, at which it crosses.

    Returns
    -------
    tuple of ndarray
        ``k Kp``, and ``k Ki`` in 1/s.
    """
    s = 1j * frequencies
    G = np.polyval(motion.numerator, s) / np.polyval(motion.denominator, s)
    needed = -np.exp(s * delay) / G
    return needed.real, -frequencies * needed.imag
