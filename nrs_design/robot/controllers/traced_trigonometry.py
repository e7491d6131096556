"""Functions of angles from sums, products and quotients: those of libm round differently.

What an encoder's ratio and a crank's length do to them is folded into their numbers.
"""

from __future__ import annotations

from nrs_design.controllers.trace import Traced
from nrs_design.robot.models.vectors import Scalar

# Fits of sin(x)/x and cos(x) in x^2 for |x| <= 2, at Chebyshev nodes, off by 9.2e-8 and 3.9e-9.
SINE = (0.999999953, -0.166666079, 0.00833215476, -0.000197582701, 2.51538628e-06)
COSINE = (0.999999996, -0.49999993, 0.0416664611, -0.00138866887, 2.46948312e-05, -2.51527899e-07)
# The tangent for |x| <= 1.5 is x times the first over the second, in x^2. The direction that it
# gives is off by 8.6e-9 rad.
RISE = (1.00000006, -0.112064173, 0.00112580742)
RUN = (1.0, -0.445396949, 0.01625689)
# Up to where they are fits, and up to where the planes of the side legs cannot be upside down.
LARGEST_ANGLE, LARGEST_PLANE_ANGLE = 2.0, 1.5


def sine_and_cosine(
    angle: Traced, ratio: float = 1.0, factor: float = 1.0, offset: float = 0.0
) -> tuple[Scalar, Scalar]:
    """Return multiples of the sine and the cosine of an angle, the second shifted.

    Parameters
    ----------
    angle : Traced
        In rad, up to `LARGEST_ANGLE` times the ratio either way.
    ratio : float
        Of that angle and the one whose functions are returned.
    factor : float
        Times both.
    offset : float
        Plus the second.
    """
    square = angle * angle
    sine = horner(_scaled(SINE, factor / ratio, ratio), square) * angle
    first, *others = _scaled(COSINE, factor, ratio)
    return sine, horner((first + offset, *others), square)


def tangent(angle: Traced, ratio: float) -> Scalar:
    """Return the tangent of an angle.

    Parameters
    ----------
    angle : Traced
        In rad, up to `LARGEST_PLANE_ANGLE` times the ratio either way.
    ratio : float
        Of that angle and the one whose tangent is returned.
    """
    square = angle * angle
    rise = _scaled(RISE, 1 / ratio, ratio)
    run = _scaled(RUN, 1 / rise[-1], ratio)
    rise = tuple(number / rise[-1] for number in rise)
    return horner(rise, square) * angle / horner(run, square)


def horner(coefficients: tuple[float, ...], x: Traced) -> Scalar:
    """Return the value of a polynomial, its constant coefficient first."""
    value: Scalar = coefficients[-1]
    for coefficient in coefficients[-2::-1]:
        value = value * x + coefficient
    return value


def _scaled(coefficients: tuple[float, ...], factor: float, ratio: float) -> tuple[float, ...]:
    """Return those of a multiple, in the square of an angle that is larger by a ratio."""
    return tuple(factor * c / ratio ** (2 * k) for k, c in enumerate(coefficients))
