"""The page of the identification of a tissue."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from nrs_design.identification.lever import in_words, named, parameter_units
from nrs_design.identification.reporting.figures.identification import (
    draw_fit,
    draw_intervals,
    draw_loop,
)
from nrs_design.identification.reporting.identification import (
    DRAWN,
    figure_names,
    identification_page,
    in_interval,
    label_of,
    marked,
)
from nrs_design.identification.statistics import span
from nrs_design.identification.tissue.offsets import OFFSET_UNITS, OFFSET_WORDS
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Block, Bullets, Illustration, Report, Section, Table
from nrs_design.reporting.formatting import number, shortened

if TYPE_CHECKING:
    from nrs_design.identification.tissue.identify import TissueIdentification
    from nrs_design.identification.tissue.output_error import RecordFit
    from nrs_design.identification.tissue.pool import ModelFit
_MEANING = (
    "Intervals are 95 % confidence intervals of the pooled parameters; with several records they "
    "hold the spread between records.",
    "The range over all records also covers the interval of every single record; its table says "
    "what else it holds.",
    "Position of contact and force in air are fitted with the law, if they are not given. Samples "
    "that are not used are drawn pale.",
    "RMSE is that of the pooled parameters in each record. AIC and BIC are sums over the records, "
    "each with parameters of its own.",
    "The p-value of the whiteness test is small where residuals are not white noise: the law then "
    "misses something, and its intervals come from the scatter between parts of the record.",
)


def tissue_report(
    found: TissueIdentification, arm: float | None = None, series: Sequence[str] = ()
) -> Report:
    """Say and draw everything about a tissue; with a lever arm in m, the law at the pivot, too."""
    chosen = found.chosen
    several = (Section("Several relaxations", (Bullets("", tuple(series)),)),) if series else ()
    values = in_words(named(chosen.law, map(in_interval, chosen.ranges), found.rotational))
    return identification_page(
        found,
        name=f"tissue-{chosen.law.name}",
        title=f"Tissue law from {counted(len(found.records), 'record')}",
        claim=f"{chosen.law.formula} with {values}. {found.reason}",
        sections=(
            Section("What of the records is used", tuple(_used(found))),
            Section("Comparison of laws", (comparison(found), *_doubts(found))),
            Section("Parameters of the chosen law", tuple(_parameters(found, arm))),
            *several,
            Section("Measured against fitted", tuple(_tissue_figures(found))),
        ),
        meaning=_MEANING,
    )


def _used(found: TissueIdentification) -> Iterator[Block]:
    """Say what was cut and why, and which offsets were found."""
    rows = tuple(
        (
            fit.record.name,
            f"{int(fit.trial.used.sum())} of {len(fit.record.force)}",
            *(_offset(fit, name, found.rotational) for name in OFFSET_WORDS),
        )
        for fit in found.chosen.fits
    )
    columns = ("Record", "Samples used", *(words.capitalize() for words in OFFSET_WORDS.values()))
    yield Table("Samples and offsets [95 % interval]", columns, rows)
    remarks = tuple(
        f"{fit.record.name}: {text}." for fit in found.chosen.fits for text in fit.trial.remarks
    )
    yield Bullets("What was found and cut", remarks)


def _offset(fit: RecordFit, name: str, rotational: bool) -> str:
    offset = next((item for item in fit.offsets if item.name == name), None)
    if offset is None:
        return "none"
    unit, estimate = OFFSET_UNITS[name][rotational], offset.estimate
    if not offset.fitted:
        return f"{number(estimate.value)} {unit}, {offset.provided or 'given'}"
    value = f"{estimate} {unit}"
    return f"{value}, {offset.provided}" if offset.provided else value


def comparison(found: TissueIdentification) -> Table:
    """Return how well each law describes the records."""
    unit = "N m" if found.rotational else "N"
    records = [record.name for record in found.records]
    least_aic = min(model.aic for model in found.models)
    least_bic = min(model.bic for model in found.models)
    rows = tuple(
        (
            marked(model.law.name, chosen=model is found.chosen),
            *(number(value, 3) for value in model.rmse),
            number(model.aic - least_aic),
            number(model.bic - least_bic),
            f"{min(fit.uncertainty.whiteness for fit in model.fits):.2g}",
            str(len(model.doubts)),
        )
        for model in found.models
    )
    columns = ("Law", *records, "AIC - least", "BIC - least", "White p", "Doubts")
    return Table(f"RMSE [{unit}] in each record, and criteria", columns, rows)


def _doubts(found: TissueIdentification) -> Iterator[Block]:
    doubts = tuple(
        f"{model.law.name}: {shortened(model.doubts, 4)}." for model in found.models if model.doubts
    )
    if doubts:
        yield Bullets("Doubts: what the records do not determine", doubts)


def _parameters(found: TissueIdentification, arm: float | None) -> Iterator[Block]:
    model = found.chosen
    law = model.law
    units = parameter_units(law, found.rotational)
    columns = (
        "Record",
        *(f"{n} [{u or '1'}]" for n, u in zip(law.parameters(), units, strict=True)),
    )
    rows = [
        (fit.record.name, *(in_interval(estimate) for estimate in fit.estimates))
        for fit in model.fits
    ]
    rows.append(("pooled", *map(in_interval, model.estimates)))
    rows.append((f"range: {found.covers}", *map(in_interval, model.ranges)))
    if arm is not None:
        values = named(law, law.at_pivot(arm).values, True)
        turned = [f"{number(value, 6)} {unit}" for _, value, unit in values]
        rows.append((f"pooled, at the pivot ({number(arm)} m)", *turned))
    yield Table("Estimates [95 % interval]", columns, tuple(rows))
    notes = [model.box] if model.box else []
    if found.tangent is not None:
        about = found.tangent
        shown = ", ".join(map(in_interval, about.ranges))
        notes.append(
            f"Small motions about deflections of {span(about.low, about.high, digits=5)}: "
            f"stiffness and damping {shown}."
        )
    if notes:
        yield Bullets("", tuple(notes))
    if law.relaxation_time is not None:
        tau = (f"The force relaxes in {number(law.relaxation_time)} s at rest.",)
        yield Bullets("", tau)
    if len(model.fits) > 1:
        yield from _interval_figures(model, units)


def _interval_figures(model: ModelFit, units: tuple[str, ...]) -> Iterator[Illustration]:
    names = [fit.record.name for fit in model.fits]
    for i, (name, unit) in enumerate(zip(model.law.parameters(), units, strict=True)):
        single = [fit.estimates[i] for fit in model.fits]
        if all(math.isfinite(estimate.high) for estimate in (*single, model.ranges[i])):
            yield Illustration(
                f"interval-{name}",
                f"{name} in each record",
                "Bars are 95 % intervals; where records differ by more than their bars, the "
                "tissue itself differs between records.",
                draw_intervals(
                    names, single, model.estimates[i], model.ranges[i], f"{name} [{unit or '1'}]"
                ),
            )


def _tissue_figures(found: TissueIdentification) -> Iterator[Illustration]:
    force, deflection = (
        ("Torque [N m]", "Angle [rad]") if found.rotational else ("Force [N]", "Deflection [m]")
    )
    note = label_of(found.sources)
    drawn = found.chosen.fits[:DRAWN]
    for fit, name in zip(drawn, figure_names([fit.record.name for fit in drawn]), strict=True):
        trial, used = fit.trial, fit.trial.used
        yield Illustration(
            f"fit-{name}",
            fit.record.name,
            f"{note}Fit to this record alone: RMSE {number(fit.rmse)}, whiteness p = "
            f"{fit.uncertainty.whiteness:.2g}; {fit.agreeing} of {counted(fit.starts, 'start')} "
            "ended at this optimum.",
            draw_fit(trial.motion.time, trial.force, fit.fitted, force, used),
        )
        yield Illustration(
            f"loop-{name}",
            f"{fit.record.name}: hysteresis",
            f"{note}The area of the loop is the energy that the tissue takes up.",
            draw_loop(trial.deflection, trial.measured, fit.fitted[used], (deflection, force)),
        )
