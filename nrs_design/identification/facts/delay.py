"""A delay between two signals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.identification.facts.finding import Facts, estimate_numbers

if TYPE_CHECKING:
    from nrs_design.identification.delay.identify import DelayIdentification


def delay_facts(found: DelayIdentification) -> Facts:
    """Return the delay beside every model, and in parts of the record."""
    record = found.record
    return {
        "columns": {"command": record.names[0], "measured": record.names[1]},
        "sampling_step_s": record.step,
        "correlation_peak": {"lag_s": found.peak[0], "correlation": found.peak[1]},
        "chosen": found.chosen.follower.name,
        "delay_s": estimate_numbers(found.delay),
        "delay_samples": estimate_numbers(found.samples),
        "parts": [
            {"time_s": time, "samples": estimate_numbers(part)} for time, part in found.parts
        ],
        "whole_samples": list(found.whole_samples),
        "fits": [
            {
                "beside": fit.follower.name,
                "delay_s": fit.delay,
                "bic": fit.bic,
                "whiteness_p": fit.uncertainty.whiteness,
            }
            for fit in found.fits
        ],
        "smooth_between_samples": found.smooth,
    }
