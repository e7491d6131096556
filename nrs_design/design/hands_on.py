"""What a hand feels that holds the robot and moves it (thesis 7.2).

The hand is the environment: with its own impedance Ze it pulls the robot along. Of the velocity v
that it means to have, the robot makes ``L/(1 + L)``, and the hand applies ``Ze/(1 + L)`` times v,
with the open loop L of the admittance.
"""

from __future__ import annotations

import numpy as np

from nrs_design.design.loops import Loops, gain_extremes
from nrs_design.design.polynomials import multiply
from nrs_design.design.transfer import FloatArray
from nrs_design.models.contact import AbstractLinearLaw


def transparency(loops: Loops, bandwidth: float) -> FloatArray:
    """Return the smallest ``|L/(1 + L)|`` from 0 to a frequency in rad/s; 0 if unstable."""
    low, _ = gain_extremes(*_cancelled(loops.numerator, loops.closed), bandwidth)
    return np.where(loops.stable, low, 0.0)


def hand_effort(loops: Loops, hand: AbstractLinearLaw, bandwidth: float) -> FloatArray:
    """Return the largest ``|Ze/(1 + L)|`` from 0 to a frequency in rad/s, in N m s/rad.

    Infinite where the loop is unstable, or where the hand has to hold against a spring.
    """
    above, below = (np.tile(part, (len(loops.numerator), 1)) for part in hand.impedance)
    numerator, denominator = _cancelled(
        multiply(above, loops.denominator), multiply(below, loops.closed)
    )
    if not np.all(denominator[:, -1]):
        return np.full(len(numerator), np.inf)
    _, high = gain_extremes(numerator, denominator, bandwidth)
    return np.where(loops.stable, high, np.inf)


def _cancelled(above: FloatArray, below: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Leave out powers of s that are in both polynomials of every row."""
    while not (above[:, -1].any() or below[:, -1].any()):
        above, below = above[:, :-1], below[:, :-1]
    return above, below
