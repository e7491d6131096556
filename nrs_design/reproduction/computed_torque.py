"""Chapter 4.2: the error dynamics of the computed-torque controller."""

from __future__ import annotations

from nrs_design.design.root_locus import design_pd
from nrs_design.reproduction import thesis
from nrs_design.reproduction.comparison import Comparison, Tolerance, reproduced

TOLERANCE = Tolerance(1e-4)


def rows() -> tuple[Comparison, ...]:
    """Recompute 4.14 and 4.15 from damping ratio and settling time."""
    wanted = design_pd(
        float(thesis.ACTUATOR.gain),
        float(thesis.ACTUATOR.time_constant),
        thesis.DAMPING_RATIO,
        thesis.SETTLING_TIME,
    )
    wn = wanted.natural_frequency
    return (
        reproduced("natural frequency wn", "4.14c", "40.2971", wn, "rad/s", TOLERANCE),
        reproduced("Kp = wn^2", "4.15a", "1623.85", wn**2, "1/s^2", TOLERANCE),
        reproduced(
            "Kd = 2 zeta wn", "4.15b", "56.9801", 2 * thesis.DAMPING_RATIO * wn, "1/s", TOLERANCE
        ),
    )
