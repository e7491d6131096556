"""Search for what a safety layer keeps (untrusted): how far its loop goes, by iteration.

From nothing, the reach of a loop grows to a fixed point, unless the motor strays too far from the
one that its responses are computed with.
"""

from __future__ import annotations

from dataclasses import fields
from fractions import Fraction
from math import ceil, log

import numpy as np

from nrs_design.proof.evidence.safety_layer import LONGEST, SafetyLayer
from nrs_design.proof.safety import Reach, SafetyBounds, SampledMotor, limits_of, reach_of, respond
from nrs_design.proof.system import SwitchedSystem
from nrs_design.search.candidates import Candidate, Candidates

# Behind the horizon, this is left of a response.
LEFT = 1e-9
ITERATIONS = 200
# By how much the claim is above the fixed point, and its digits.
MORE, DIGITS = Fraction(1, 10**6), 8


def search_safety(system: SwitchedSystem) -> Candidates[SafetyLayer]:
    """Yield the reach of the loop and its limits.

    Parameters
    ----------
    system : SwitchedSystem
        With a safety layer.
    """
    loop, period = system.safety, system.sample_time
    if loop is None or period is None:
        return "there is no safety layer"
    motor = SampledMotor.of(loop, period)
    A = np.array([[float(entry) for entry in row] for row in motor.matrix(loop)])
    radius = float(max(abs(np.linalg.eigvals(A))))
    if radius >= 1:
        return "the motion loop is not stable"
    horizon = ceil(log(LEFT) / log(max(radius, 0.1)))
    if horizon > LONGEST:
        return "the motion loop is too slow for its period"
    found = respond(loop, motor, horizon, loop.oldest)
    if found is None:
        return "the motion loop has not died down by the horizon"
    reach, before = Reach(*[Fraction(0)] * 4), None
    for _ in range(ITERATIONS):
        if reach == before:
            break
        before = reach
        reach = Reach(*map(_above, _numbers(reach_of(loop, motor, found, reach))))
    else:
        return "the ranges of the motor are too wide for the bounds of the layer"
    reach = Reach(*(_above(number * (1 + MORE)) for number in _numbers(reach)))
    limits = SafetyBounds(*map(_above, _numbers(limits_of(loop, period, motor, found, reach))))
    yield Candidate(SafetyLayer(horizon, reach, limits))
    return None


def _numbers(item: Reach | SafetyBounds) -> list[Fraction]:
    return [getattr(item, field.name) for field in fields(item)]


def _above(number: Fraction) -> Fraction:
    """Round up to so many digits."""
    if not number:
        return number
    size = Fraction(10) ** (DIGITS - ceil(log(number, 10)))
    return Fraction(ceil(number * size)) / size
