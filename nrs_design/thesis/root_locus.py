"""Chapters 4.2 and 4.3, equation 6.1: error dynamics, PD controller, the loop that it closes."""

from __future__ import annotations

from collections.abc import Iterator
from math import degrees, exp, pi, sqrt

from nrs_design.design.root_locus import PdDesign, design_pd, motion_loop_response
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import Found, Recomputed


def _pd(time_constant: float) -> PdDesign:
    gain = float(thesis.ACTUATOR.gain)
    return design_pd(gain, time_constant, thesis.DAMPING_RATIO, thesis.SETTLING_TIME)


def results() -> Iterator[Found]:
    """Recompute the design by angle and magnitude condition, then what it really gives."""
    # The thesis places the zero with the pole of 4.26b, the gain with the rounded 0.0351 s of 4.29.
    unrounded, rounded = _pd(1 / thesis.BREAK_FREQUENCY), _pd(float(thesis.ACTUATOR.time_constant))
    wn, zeta = rounded.natural_frequency, thesis.DAMPING_RATIO
    yield from (wn, wn**2, 2 * zeta * wn)
    yield unrounded.wanted_poles[0]
    facts = f"{rounded.zero:.4f}", f"{degrees(unrounded.zero_angle):.4f}"
    yield Recomputed(degrees(rounded.zero_angle), facts=facts)
    yield from (unrounded.zero, rounded.derivative_gain)
    yield float(thesis.DERIVATIVE_GAIN * thesis.ZERO)
    loop = thesis.EXACT_LOOP
    response = motion_loop_response(loop)
    yield from (response.poles[0], response.damping_ratio)
    second_order = exp(-pi * zeta / sqrt(1 - zeta**2))
    yield Recomputed(100 * response.overshoot, facts=(f"{100 * second_order:.1f}",))
    yield (*loop.numerator, *loop.denominator)
