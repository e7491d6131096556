"""Fits of an actuator."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.identification.facts.finding import Facts, estimate_numbers

if TYPE_CHECKING:
    from nrs_design.identification.actuator.identify import ActuatorIdentification
    from nrs_design.identification.actuator.model import ActuatorFit


def actuator_facts(found: ActuatorIdentification) -> Facts:
    """Return every fit and the chosen one."""
    figures = found.figures
    return {
        "command_unit": found.unit,
        "sampling_step_s": found.step,
        "chosen": found.chosen.method,
        "reason": found.reason,
        "fits": [_fit(fit, found) for fit in found.fits],
        "range": {
            f"gain_rad_s_{found.unit}": estimate_numbers(found.ranges[0]),
            "time_constant_s": estimate_numbers(found.ranges[1]),
        },
        "range_covers": found.coverage,
        "range_covers_words": found.covers,
        "resistance_ohm": estimate_numbers(figures.resistance) if figures else None,
        "speed_torque_gradient_rpm_per_Nm": estimate_numbers(figures.gradient) if figures else None,
        "response": [
            {"frequency_rad_s": w, "real": value.real, "imaginary": value.imag}
            for w, value in zip(found.frequency.tolist(), found.response.tolist(), strict=True)
        ],
    }


def _fit(fit: ActuatorFit, found: ActuatorIdentification) -> Facts:
    late = fit.dead_time
    return {
        "method": fit.method,
        "order": fit.order,
        f"gain_rad_s_{found.unit}": estimate_numbers(fit.gain),
        "time_constant_s": estimate_numbers(fit.time_constant),
        "damping_ratio": fit.motor.damping if fit.motor else None,
        f"friction_{found.unit}": estimate_numbers(fit.friction) if fit.friction else None,
        "dead_time_s": estimate_numbers(late) if late else None,
        "dead_time_samples": estimate_numbers(late.scaled(1 / found.step))
        if late and found.step
        else None,
        "whiteness_p": fit.uncertainty.whiteness,
    }
