"""Chapter 6.3.3.1: the proportional force controller."""

from __future__ import annotations

import math

from nrs_design.design.force_limit import Approach, peak_force, steady_force_error
from nrs_design.design.force_loop import force_loop_response
from nrs_design.spec.controllers import Offset
from nrs_design.thesis import thesis
from nrs_design.thesis.comparison import (
    ReproducedValue,
    Tolerance,
    derived,
    misprint,
    reproduced,
)


def rows() -> tuple[ReproducedValue, ...]:
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
            errata=("6.33",),
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
            errata=("6.33",),
        ),
        *_offset_rows(),
    )


def _offset_rows() -> tuple[ReproducedValue, ReproducedValue]:
    """Recompute the force limit of 6.3.3.3 for both readings of X_i in 6.41."""
    speeds = (3.0, 5.0, 8.0)
    peak, left = _limited("reference", 5.0)
    positions = [_limited("measured", speed) for speed in speeds]
    return (
        derived(
            "peak torque, steady error; X_i the reference at the switch, 5 deg/s",
            "6.41",
            (peak, left),
            "N m, %",
            printed="0.35 measured in phi; 2 in phi and 12 in psi",
            right=("0.3477", "11.84"),
            tolerance=Tolerance(2e-4),
            note="Kp 0.02, k_soft, Fd 0.3 N m. The error is k v/(Kv (1 + Kp k) Fd): it grows with "
            f"the speed, and is 2 % at {10 / left:.2f} deg/s. Without X_i it would be 53.7 %.",
        ),
        derived(
            "peak torque at 3, 5, 8 deg/s, steady error; X_i the measured position at the switch",
            "6.41",
            (*(force for force, _ in positions), max(error for _, error in positions)),
            "N m, %",
            printed="an integrator is held to be needed",
            right=("0.3091", "0.3152", "0.3243", "0"),
            tolerance=Tolerance(2e-4, absolute=1e-9),
            note="No error is left at any speed, and no integrator is needed. The modes with the "
            "resets of X_i are proved stable: specs/neuroboscope/force-limit-offset.nrs.yaml.",
        ),
    )


def _limited(offset: Offset, speed: float) -> tuple[float, float]:
    """Return the peak torque in N m and the steady error in %, arriving at a speed in deg/s."""
    approach = Approach(offset, math.radians(speed), 0.3)
    at = (thesis.EXACT_LOOP, float(thesis.SOFT), float(thesis.FORCE_GAIN), approach)
    peak = peak_force(*at)
    assert peak is not None
    return peak, 100 * steady_force_error(*at)
