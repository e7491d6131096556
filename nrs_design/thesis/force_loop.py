"""Chapter 6.3.3.1: the proportional force controller."""

from __future__ import annotations

import math
from collections.abc import Iterable

from nrs_design.design.force_loop import (
    Approach,
    force_loop_response,
    peak_force,
    steady_force_error,
)
from nrs_design.spec.controllers import Offset
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Found, Recomputed


def results() -> Iterable[Found]:
    """Recompute the open loop 6.33, what Kp = 0.02 gives, and 6.3.3.3 for both X_i of 6.41."""
    stiffness, loop = float(thesis.SOFT), thesis.EXACT_LOOP
    closed = force_loop_response(loop, stiffness, float(thesis.FORCE_GAIN))
    limit = force_loop_response(loop, stiffness, 0.0)
    at_zero = (f"{limit.damping_ratio:.4f}", f"{limit.natural_frequency:.2f}")
    peak, left = _limited("reference", 5.0)
    positions = [_limited("measured", speed) for speed in (3.0, 5.0, 8.0)]
    return (
        (*(stiffness * b for b in loop.numerator), *loop.denominator),
        Recomputed(closed.damping_ratio, facts=at_zero),
        Recomputed(closed.natural_frequency, facts=at_zero),
        Recomputed((peak, left), facts=(f"{10 / left:.2f}",)),
        (*(force for force, _ in positions), max(error for _, error in positions)),
    )


def _limited(offset: Offset, speed: float) -> tuple[float, float]:
    """Return the peak torque in N m and the steady error in %, arriving at a speed in deg/s."""
    approach = Approach(offset, math.radians(speed), 0.3)
    at = (thesis.EXACT_LOOP, float(thesis.SOFT), float(thesis.FORCE_GAIN), approach)
    peak = peak_force(*at)
    assert peak is not None
    return peak, 100 * steady_force_error(*at)
