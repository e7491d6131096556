"""Chapters 4.2 and 4.3, equation 6.1: error dynamics, PD controller, the loop that it closes."""

from __future__ import annotations

from math import degrees, exp, pi, sqrt

from nrs_design.design.root_locus import PdDesign, design_pd, motion_loop_response
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import ReproducedValue, Tolerance, derived, reproduced


def rows() -> tuple[ReproducedValue, ...]:
    """Recompute the design by angle and magnitude condition, then what it really gives."""
    return (*_error_dynamics(), *_design(), *_closed_loop())


def _pd(time_constant: float) -> PdDesign:
    gain = float(thesis.ACTUATOR.gain)
    return design_pd(gain, time_constant, thesis.DAMPING_RATIO, thesis.SETTLING_TIME)


def _error_dynamics() -> tuple[ReproducedValue, ...]:
    """Recompute the gains of computed torque from damping ratio and settling time."""
    wn, tolerance = _pd(float(thesis.ACTUATOR.time_constant)).natural_frequency, Tolerance(1e-4)
    damping = 2 * thesis.DAMPING_RATIO * wn
    return (
        reproduced("natural frequency wn", "4.14c", "40.2971", wn, "rad/s", tolerance),
        reproduced("Kp = wn^2", "4.15a", "1623.85", wn**2, "1/s^2", tolerance),
        reproduced("Kd = 2 zeta wn", "4.15b", "56.9801", damping, "1/s", tolerance),
    )


def _design() -> tuple[ReproducedValue, ...]:
    # The thesis places the zero with the pole of 4.26b, the gain with the rounded 0.0351 s of 4.29.
    unrounded, rounded = _pd(1 / thesis.BREAK_FREQUENCY), _pd(float(thesis.ACTUATOR.time_constant))
    return (
        reproduced(
            "wanted poles",
            "4.27b",
            "-28.4900 +- 28.49861j",
            unrounded.wanted_poles[0],
            "rad/s",
            Tolerance(1e-4),
        ),
        reproduced(
            "angle of the zero",
            "4.28",
            "44.9914",
            degrees(rounded.zero_angle),
            "deg",
            Tolerance(1e-5),
            note=f"For tau_m = 0.0351 s, whose zero would be at {rounded.zero:.4f} 1/s. The zero "
            "of 4.29 is that of the pole at 28.4767 1/s, whose angle is "
            f"{degrees(unrounded.zero_angle):.4f} deg.",
            errata=("4.28",),
        ),
        reproduced("zero", "4.29", "56.9706", unrounded.zero, "1/s", Tolerance(5e-4)),
        derived(
            "gain K of the magnitude condition",
            "4.30",
            rounded.derivative_gain,
            "rpm s/rad",
            printed="2060, chosen",
            tolerance=Tolerance(1e-4),
            right="2065.4",
            note="2060 is read off the drawn locus and rounded. "
            "What follows in the thesis, and here, uses 2060.",
            errata=("4.30",),
        ),
        reproduced(
            "Kp = K z",
            "4.31",
            "117359.43",
            float(thesis.DERIVATIVE_GAIN * thesis.ZERO),
            "rpm/rad",
            Tolerance(1e-5),
        ),
    )


def _closed_loop() -> tuple[ReproducedValue, ...]:
    loop = thesis.EXACT_LOOP
    response = motion_loop_response(loop)
    second_order = exp(-pi * thesis.DAMPING_RATIO / sqrt(1 - thesis.DAMPING_RATIO**2))
    return (
        derived(
            "closed-loop poles at K = 2060",
            "4.3",
            response.poles[0],
            "rad/s",
            tolerance=Tolerance(1e-4),
            right="-28.453 +- 28.448j",
            note="The thesis prints the wanted poles only; the rounded gain falls short of them.",
        ),
        reproduced(
            "damping ratio at K = 2060",
            "4.3",
            "0.707",
            response.damping_ratio,
            "",
            Tolerance(1e-3),
        ),
        derived(
            "step overshoot at K = 2060",
            "4.3",
            100 * response.overshoot,
            "%",
            tolerance=Tolerance(absolute=0.2),
            right="6.8",
            note="The criterion zeta = 0.707 stands for "
            f"{100 * second_order:.1f} % in a second-order system without a zero; the zero of "
            "the PD controller stays in the closed loop and adds to it.",
        ),
        reproduced(
            "motion loop G, numerator and denominator",
            "6.1",
            ("0.99", "56.82", "0.0351", "1.99", "56.82"),
            (*loop.numerator, *loop.denominator),
            "",
            Tolerance(1e-3),
            right=("0.9974", "56.822", "0.0351", "1.9974", "56.822"),
            note="6.33 prints 1.997 for the same coefficient.",
        ),
    )
