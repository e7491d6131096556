"""Chapter 6.3.3.1: the proportional force controller."""

from __future__ import annotations

from nrs_design.design.force_loop import force_loop_response
from nrs_design.reproduction import thesis
from nrs_design.reproduction.comparison import Comparison, Tolerance, misprint, reproduced


def rows() -> tuple[Comparison, ...]:
    """Recompute the open loop 6.33 and the poles that Kp = 0.02 gives."""
    stiffness = float(thesis.SOFT)
    loop = thesis.EXACT_LOOP
    closed = force_loop_response(loop, stiffness, float(thesis.FORCE_GAIN))
    limit = force_loop_response(loop, stiffness, 0.0)
    note = (
        "The printed value holds for Kp -> 0 (there "
        f"{limit.damping_ratio:.4f} and {limit.natural_frequency:.2f} rad/s); it does not fix Kp."
    )
    return (
        reproduced(
            "open force loop, numerator and denominator",
            "6.33",
            ("42.92", "2445", "0.0351", "1.997", "56.82"),
            (*(stiffness * b for b in loop.numerator), *loop.denominator),
            "",
            Tolerance(5e-4),
        ),
        misprint(
            "damping ratio at Kp = 0.02",
            "6.3.3.1",
            "0.707",
            closed.damping_ratio,
            "",
            Tolerance(1e-3),
            right="0.741",
            note=note,
        ),
        misprint(
            "natural frequency at Kp = 0.02",
            "6.3.3.1",
            "40.2971",
            closed.natural_frequency,
            "rad/s",
            Tolerance(1e-3),
            right="54.9",
            note=note,
        ),
    )
