"""The page of an identified delay."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nrs_design.identification.reporting.figures.delay import draw_delay, draw_following
from nrs_design.identification.reporting.identification import (
    identification_page,
    in_interval,
    label_of,
    marked,
)
from nrs_design.identification.statistics import span
from nrs_design.reporting.document import Illustration, Report, Section, Table
from nrs_design.reporting.formatting import number

if TYPE_CHECKING:
    from nrs_design.identification.delay.identify import DelayIdentification

_MEANING = (
    "The delay is dead time beyond the dynamics of the model beside it; a loop of another model "
    "has another delay. The least BIC chose the model.",
    "The interval is at 95 % for a constant delay; parts of the record show whether it varies, at "
    "95 % for all parts together.",
)


def delay_report(found: DelayIdentification) -> Report:
    """Say and draw everything about the delay of a record."""
    record, samples = found.record, found.samples
    sent, seen = record.names
    return identification_page(
        found,
        name="delay",
        title=f"Delay from {sent} to {seen}",
        claim=f"{in_interval(samples)} samples of {number(record.step, 4)} s, beside "
        f"{found.chosen.follower.name}. Whole samples that hold it and every part of the record: "
        f"{span(*found.whole_samples)}.",
        sections=(
            Section("Models", (delays(found),)),
            Section(
                "Figures",
                (
                    Illustration(
                        "following",
                        "Measured against fitted",
                        f"{label_of(found.sources)}Where the command changes most.",
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
        ),
        meaning=_MEANING,
    )


def delays(found: DelayIdentification) -> Table:
    """Return the delay beside each model."""
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
