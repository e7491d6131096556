"""The page of an identified delay."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.identification.reporting.figures.delay import draw_delay, draw_following
from nrs_design.identification.reporting.identification import identification_page, label_of
from nrs_design.reporting.document import Bullets, Illustration, Report, Section, Table
from nrs_design.reporting.formatting import number

if TYPE_CHECKING:
    from nrs_design.identification.delay import DelayIdentification

_MEANING = (
    "The delay is dead time beyond the dynamics of the model beside it; a loop of another model "
    "has another delay. The least BIC chose the model.",
    "The interval is at 95 % for a constant delay; parts of the record show whether it varies, at "
    "95 % for all parts together.",
)


def delay_report(found: DelayIdentification) -> Report:
    """Say and draw everything about the delay of a record."""
    record, samples = found.record, found.samples
    low, high = found.whole_samples
    sent, seen = record.names
    rows = tuple(
        (
            fit.follower.name + (" (chosen)" if fit is found.chosen else ""),
            number(fit.delay / record.step, 4),
            number(fit.bic - found.chosen.bic, 4),
        )
        for fit in found.fits
    )
    table = Table("Delay beside each model", ("Beside", "Samples", "BIC - least"), rows)
    return identification_page(
        name="delay",
        title=f"Delay from {sent} to {seen}",
        claim=f"{number(samples.value, 4)} "
        f"[{number(samples.low, 4)}, {number(samples.high, 4)}] samples of "
        f"{number(record.step, 4)} s, beside {found.chosen.follower.name}. Whole samples that hold "
        f"it and every part of the record: {low} to {high}.",
        remarks=(
            *(f"Remark: {remark}." for remark in found.remarks),
            *(f"Doubt: {doubt}." for doubt in found.doubts),
        ),
        sources=[record.source],
        sections=(
            Section("Models", (table,)),
            Section(
                "Figures",
                (
                    Illustration(
                        "following",
                        "Measured against fitted",
                        f"{label_of(record.source.synthetic)}Where the command changes most.",
                        draw_following(found),
                    ),
                    Illustration(
                        "parts",
                        "Delay in parts of the record",
                        "Bars: intervals at 95 % for all parts together. Shaded: for the record.",
                        draw_delay(found),
                    ),
                ),
            ),
            Section("How to read this", (Bullets("", _MEANING),), boxed=True),
        ),
    )
