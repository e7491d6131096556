"""Output of the identification of a delay."""

from __future__ import annotations

from collections.abc import Iterator

from nrs_design.identification.delay.identify import DelayIdentification
from nrs_design.identification.reporting.figures import draw_fit
from nrs_design.identification.reporting.view import (
    Facts,
    FindingView,
    estimate_numbers,
    label_of,
    marked,
)
from nrs_design.identification.statistics import span
from nrs_design.reporting.document import Illustration, Section, Table
from nrs_design.reporting.formatting import number

_MEANING = (
    "The delay is dead time beyond the dynamics of the model beside it; a loop of another model "
    "has another delay. The least BIC chose the model.",
    "The interval is at 95 % for a constant delay; parts of the record show whether it varies, at "
    "95 % for all parts together.",
)


def view_delay(found: DelayIdentification) -> FindingView:
    """Return the output of the identification of a delay."""
    (sent, seen), (lag, correlation) = found.record.names, found.peak
    model, step, whole = found.chosen.follower.name, found.record.step, span(*found.whole_samples)
    when = f"{abs(lag):.4g} s {'later' if lag >= 0 else 'earlier'}"
    return FindingView(
        found,
        kind="delay",
        chosen=model,
        reason=f"from {sent} to {seen}",
        ranges={"delay": (found.delay, "s"), "samples": (found.samples, "samples")},
        facts=_facts(found),
        lines=(
            f"{seen} is most like {sent} {when} (correlation {correlation:.3f})",
            f"delay = {found.samples} samples of {step:.4g} s [95 %]",
            f"delay = {found.delay} s, beside {model}",
            f"whole samples that hold it, and every part of the record: {whole}",
        ),
        details=(),
        fits=_table(found),
        title=f"Delay from {sent} to {seen}",
        claim=f"{found.samples} samples of {number(step, 4)} s, beside {model}. Whole "
        f"samples that hold it and every part of the record: {whole}.",
        sections=lambda: _sections(found),
        meaning=_MEANING,
    )


def _table(found: DelayIdentification) -> Table:
    least = min(fit.bic for fit in found.fits)
    rows = tuple(
        (
            marked(fit.follower.name, chosen=fit is found.chosen),
            number(fit.delay / found.record.step),
            number(fit.bic - least),
        )
        for fit in found.fits
    )
    return Table("Delay beside each model", ("Beside", "Samples", "BIC - least"), rows)


def _facts(found: DelayIdentification) -> Facts:
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


def _sections(found: DelayIdentification) -> Iterator[Section]:
    rows = tuple((number(time), str(part)) for time, part in found.parts)
    parts = Table("Delay in parts of the record", ("Middle [s]", "Samples"), rows)
    yield Section("Models", (_table(found), parts))
    record = found.record
    figure = draw_fit(record.time, record.output, found.chosen.fitted, record.names[1])
    note = label_of(found.sources)
    drawn = Illustration("following", "Measured against fitted", note, figure)
    yield Section("Figures", (drawn,))
