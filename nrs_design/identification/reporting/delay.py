"""Output of the identification of a delay."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.identification.delay.identify import DelayIdentification
from nrs_design.identification.reporting.view import (
    Facts,
    FindingView,
    draw_fit,
    estimate_numbers,
    label_of,
    marked,
)
from nrs_design.identification.statistics import span
from nrs_design.reporting.document import Illustration, Section, Table
from nrs_design.reporting.formatting import number


def view_delay(result: DelayIdentification) -> FindingView:
    """Return the output of the identification of a delay."""
    (command, output), (lag, correlation) = result.record.names, result.peak
    model, step, whole = (
        result.chosen.follower.name,
        result.record.step,
        span(*result.whole_samples),
    )
    direction = f"{abs(lag):.4g} s {'later' if lag >= 0 else 'earlier'}"
    return FindingView(
        result,
        kind="delay",
        chosen=model,
        reason=f"from {command} to {output}",
        ranges={"delay": (result.delay, "s"), "samples": (result.samples, "samples")},
        facts=_facts(result),
        lines=(
            f"{output} is most like {command} {direction} (correlation {correlation:.3f})",
            f"delay = {result.samples} samples of {step:.4g} s [95 %]",
            f"delay = {result.delay} s, beside {model}",
            f"whole samples that hold it, and every part of the record: {whole}",
        ),
        details=(),
        fits=_table(result),
        title=f"Delay from {command} to {output}",
        claim=f"{result.samples} samples of {number(step, 4)} s, beside {model}. Whole "
        f"samples that hold it and every part of the record: {whole}.",
        sections=lambda: _sections(result),
    )


def _table(result: DelayIdentification) -> Table:
    lowest = min(fit.bic for fit in result.fits)
    rows = tuple(
        (
            marked(fit.follower.name, chosen=fit is result.chosen),
            number(fit.delay / result.record.step),
            number(fit.bic - lowest),
        )
        for fit in result.fits
    )
    return Table("Delay beside each model", ("Beside", "Samples", "BIC - least"), rows)


def _facts(result: DelayIdentification) -> Facts:
    record = result.record
    return {
        "columns": {"command": record.names[0], "measured": record.names[1]},
        "sampling_step_s": record.step,
        "correlation_peak": {"lag_s": result.peak[0], "correlation": result.peak[1]},
        "chosen": result.chosen.follower.name,
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


def _sections(result: DelayIdentification) -> Iterator[Section]:
    rows = tuple((number(time), str(part)) for time, part in result.parts)
    parts = Table("Delay in parts of the record", ("Middle [s]", "Samples"), rows)
    yield Section("Models", (_table(result), parts))
    record = result.record
    figure = draw_fit(record.time, record.output, result.chosen.fitted, record.names[1])
    note = label_of(result.sources)
    illustration = Illustration("following", "Measured against fitted", note, figure)
    yield Section("Figures", (illustration,))
