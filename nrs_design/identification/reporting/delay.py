"""Output of the identification of a delay."""

from __future__ import annotations

from nrs_design.identification.delay.identify import DelayIdentification
from nrs_design.identification.reporting.view import (
    Curve,
    Facts,
    FindingView,
    estimate_numbers,
    marked,
)
from nrs_design.identification.statistics import span
from nrs_design.reporting.document import Table
from nrs_design.reporting.formatting import number


def view_delay(result: DelayIdentification) -> FindingView:
    """Return the output of the identification of a delay."""
    record, (lag, correlation) = result.record, result.peak
    command, output = record.names
    model, whole = result.fit.follower.name, span(*result.whole_samples)
    direction = f"{abs(lag):.4g} s {'later' if lag >= 0 else 'earlier'}"
    parts = tuple((number(time), str(part)) for time, part in result.parts)
    curve = (record.time, record.output, result.fit.fitted)
    return FindingView(
        result,
        kind="delay",
        method=model,
        reason=f"from {command} to {output}",
        ranges={"delay": (result.delay, "s"), "samples": (result.samples, "samples")},
        facts=_facts(result),
        lines=(
            f"{output} is most like {command} {direction} (correlation {correlation:.3f})",
            f"delay = {result.samples} samples of {record.step:.4g} s [95 %]",
            f"delay = {result.delay} s, beside {model}",
            f"whole samples that hold it, and every part of the record: {whole}",
        ),
        fits=_table(result),
        blocks=(Table("Delay in parts of the record", ("Middle [s]", "Samples"), parts),),
        title=f"Delay from {command} to {output}",
        claim=f"{result.samples} samples of {number(record.step, 4)} s, beside {model}. Whole "
        f"samples that hold it and every part of the record: {whole}.",
        curves=lambda: (Curve(record.name, f"Beside {model}.", output, *curve),),
    )


def _table(result: DelayIdentification) -> Table:
    lowest = min(fit.bic for fit in result.fits)
    rows = tuple(
        (
            marked(fit.follower.name, is_chosen=fit is result.fit),
            number(fit.delay / result.record.step),
            number(fit.bic - lowest),
        )
        for fit in result.fits
    )
    return Table("Delay with each model", ("Model", "Samples", "BIC - least"), rows)


def _facts(result: DelayIdentification) -> Facts:
    record = result.record
    return {
        "columns": {"command": record.names[0], "measured": record.names[1]},
        "sampling_step_s": record.step,
        "correlation_peak": {"lag_s": result.peak[0], "correlation": result.peak[1]},
        "chosen": result.fit.follower.name,
        "delay_s": estimate_numbers(result.delay),
        "delay_samples": estimate_numbers(result.samples),
        "parts": [
            {"time_s": time, "samples": estimate_numbers(part)} for time, part in result.parts
        ],
        "whole_samples": list(result.whole_samples),
        "fits": [
            {
                "beside": fit.follower.name,
                "delay_s": fit.delay,
                "bic": fit.bic,
                "whiteness_p": fit.uncertainty.whiteness,
            }
            for fit in result.fits
        ],
        "smooth_between_samples": result.smooth,
    }
