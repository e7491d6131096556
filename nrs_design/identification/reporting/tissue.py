"""Output of the identification of a tissue."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeVar

from nrs_design.identification.reporting.figures import draw_fit
from nrs_design.identification.reporting.view import (
    DRAWN,
    Facts,
    FindingView,
    estimate_numbers,
    figure_names,
    label_of,
    marked,
)
from nrs_design.identification.statistics import Estimate, span
from nrs_design.identification.tissue.identify import TissueIdentification
from nrs_design.identification.tissue.output_error import RecordFit
from nrs_design.identification.tissue.pool import ModelFit
from nrs_design.identification.tissue.tangent import Tangent
from nrs_design.models.contact import AbstractContactLaw
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Block, Bullets, Illustration, Section, Table
from nrs_design.reporting.formatting import number, shortened

T = TypeVar("T")

_MEANING = (
    "Intervals are 95 % confidence intervals of the pooled parameters; with several records they "
    "hold the spread between records.",
    "The range over all records also covers the interval of every single record; its table says "
    "what else it holds.",
    "Position of contact and force in air are fitted with the law, if they are not given. Samples "
    "that are not used are drawn pale.",
    "RMSE and BIC, which is a sum over the records, are those of parameters of its own in each "
    "record.",
    "The p-value of the whiteness test is small where residuals are not white noise: the law then "
    "misses something, and its intervals come from the scatter between parts of the record.",
)


def view_tissue(found: TissueIdentification, arm: float | None = None) -> FindingView:
    """Return the output for a tissue; with a lever arm in m, the law at the pivot, too."""
    model, law = found.chosen, found.chosen.law
    ranges = _named(law, model.ranges, found.rotational)
    values = _in_words(_named(law, map(str, model.ranges), found.rotational))
    return FindingView(
        found,
        kind="tissue",
        chosen=law.name,
        reason=found.reason,
        ranges={name: (estimate, unit) for name, estimate, unit in ranges},
        facts=_facts(found, arm),
        lines=(
            found.reason,
            *(f"{_in_words([row])} holds {found.covers}" for row in ranges),
            *_notes(found, arm),
        ),
        details=_used(found),
        fits=_table(found),
        title=f"Tissue law from {counted(len(found.records), 'record')}",
        claim=f"{law.formula} with {values}. {found.reason}",
        sections=lambda: _sections(found, arm),
        meaning=_MEANING,
    )


def _named(
    law: AbstractContactLaw, values: Iterable[T], rotational: bool
) -> list[tuple[str, T, str]]:
    """Return name, value and unit of each parameter of a law."""
    units = _units(law, rotational)
    return list(zip(law.parameters(), values, units, strict=True))


def _in_words(parameters: Iterable[tuple[str, object, str]]) -> str:
    """Write parameters with their values and units."""
    return ", ".join(f"{name} = {value} {unit}".rstrip() for name, value, unit in parameters)


def _units(law: AbstractContactLaw, rotational: bool) -> tuple[str, ...]:
    """Return the units of the parameters of a law, as people read them."""
    return tuple(unit.replace("*", " ") for unit in law.units(rotational=rotational))


def _notes(found: TissueIdentification, arm: float | None) -> Iterator[str]:
    """Yield the tangent, and the law at the pivot, in words."""
    law, about = found.chosen.law, found.tangent
    if about is not None:
        length = "rad" if found.rotational else "m"
        values = _in_words(_named(about.law, about.ranges, found.rotational))
        yield f"small motions about {span(about.low, about.high, length, 5)}: {values}"
        *power, exponent = about.power
        values = _in_words([*_named(about.law, power, found.rotational), ("phi", exponent, "")])
        yield f"the law itself, by its tangent at {about.about:.5g} {length}: {values}"
    if arm is not None:
        turned = [f"{value:.6g}" for value in law.at_pivot(arm).values]
        yield f"at the pivot: {_in_words(_named(law, turned, True))}"


def _used(found: TissueIdentification) -> tuple[str, ...]:
    """Return the used samples and the offsets of each record, in words."""
    return tuple(
        "; ".join(
            (
                f"{fit.record.name}: {int(fit.trial.used.sum())} of "
                f"{counted(len(fit.record.force), 'sample')} used",
                *(offset.text(rotational=found.rotational) for offset in fit.offsets),
                *fit.trial.remarks,
            )
        )
        for fit in found.chosen.fits
    )


def _table(found: TissueIdentification) -> Table:
    """Return how well each law describes the records."""
    records = [record.name for record in found.records]
    least = min(model.bic for model in found.models)
    rows = tuple(
        (
            marked(model.law.name, chosen=model is found.chosen),
            *(number(fit.rmse, 3) for fit in model.fits),
            number(model.bic - least),
            f"{min(fit.uncertainty.whiteness for fit in model.fits):.2g}",
            str(len(model.doubts)),
        )
        for model in found.models
    )
    unit = "N m" if found.rotational else "N"
    columns = ("Law", *records, "BIC - least", "White p", "Doubts")
    return Table(f"RMSE [{unit}] in each record, and criteria", columns, rows)


def _facts(found: TissueIdentification, arm: float | None) -> Facts:
    law, about = found.chosen.law, found.tangent
    turned = None if arm is None else law.at_pivot(arm).values
    return {
        "chosen": law.name,
        "reason": found.reason,
        "ranges": _numbers(law, found.chosen.ranges, found.rotational),
        "tangent": None if about is None else _tangent(about, found.rotational),
        "range_covers": found.chosen.coverage,
        "range_covers_words": found.covers,
        "at_pivot": turned and dict(zip(law.parameters(), turned, strict=True)),
        "models": [_model(model, found.rotational) for model in found.models],
    }


def _numbers(law: AbstractContactLaw, estimates: Iterable[Estimate], rotational: bool) -> Facts:
    return {
        name: estimate_numbers(estimate) | {"unit": unit}
        for name, estimate, unit in _named(law, estimates, rotational)
    }


def _tangent(about: Tangent, rotational: bool) -> Facts:
    *power, exponent = about.power
    law = _numbers(about.law, power, rotational) | {"phi": estimate_numbers(exponent)}
    return {
        "preload": [about.low, about.high],
        "ranges": _numbers(about.law, about.ranges, rotational),
        "about": about.about,
        "law": law,
    }


def _model(model: ModelFit, rotational: bool) -> Facts:
    return {
        "law": model.law.name,
        "parameters": _numbers(model.law, model.estimates, rotational),
        "relaxation_time_s": model.law.relaxation_time,
        "bic": model.bic,
        "doubts": list(model.doubts),
        "records": [_record(fit, rotational) for fit in model.fits],
    }


def _record(fit: RecordFit, rotational: bool) -> Facts:
    return {
        "parameters": _numbers(fit.law, fit.estimates, rotational),
        "rmse": fit.rmse,
        "bic": fit.bic,
        "offsets": {
            offset.name: estimate_numbers(offset.estimate)
            | {"fitted": offset.fitted, "provided": offset.provided or None}
            for offset in fit.offsets
        },
        "used": int(fit.trial.used.sum()),
        "samples": len(fit.record.force),
        "cuts": list(fit.trial.cuts),
        "remarks": list(fit.trial.remarks),
        "r2": fit.r2,
        "residual_over_range": fit.rmse / fit.trial.span,
        "whiteness_p": fit.uncertainty.whiteness,
    }


def _sections(found: TissueIdentification, arm: float | None) -> Iterator[Section]:
    used = Bullets("Offsets are with 95 % intervals", _used(found))
    yield Section("What of the records is used", (used,))
    yield Section("Comparison of laws", (_table(found), *_doubts(found)))
    yield Section("Parameters of the chosen law", tuple(_parameters(found, arm)))
    yield Section("Measured against fitted", tuple(_figures(found)))


def _doubts(found: TissueIdentification) -> Iterator[Block]:
    doubts = tuple(
        f"{model.law.name}: {shortened(model.doubts, 4)}." for model in found.models if model.doubts
    )
    if doubts:
        yield Bullets("Doubts: what the records do not determine", doubts)


def _parameters(found: TissueIdentification, arm: float | None) -> Iterator[Block]:
    model, law = found.chosen, found.chosen.law
    units = _units(law, found.rotational)
    names = (f"{n} [{u or '1'}]" for n, u in zip(law.parameters(), units, strict=True))
    rows = (
        *((fit.record.name, *map(str, fit.estimates)) for fit in model.fits),
        ("pooled", *map(str, model.estimates)),
        (f"range: {found.covers}", *map(str, model.ranges)),
    )
    yield Table("Estimates [95 % interval]", ("Record", *names), rows)
    notes = [f"{note[0].upper()}{note[1:].rstrip('.')}." for note in _notes(found, arm)]
    if law.relaxation_time is not None:
        notes.append(f"The force relaxes in {number(law.relaxation_time)} s at rest.")
    if notes:
        yield Bullets("", tuple(notes))


def _figures(found: TissueIdentification) -> Iterator[Illustration]:
    fits = found.chosen.fits[:DRAWN]
    for fit, name in zip(fits, figure_names([fit.record.name for fit in fits]), strict=True):
        trial = fit.trial
        label = "Torque [N m]" if found.rotational else "Force [N]"
        yield Illustration(
            f"fit-{name}",
            fit.record.name,
            f"{label_of(found.sources)}Fit to this record alone: RMSE {number(fit.rmse)}, "
            f"whiteness p = {fit.uncertainty.whiteness:.2g}.",
            draw_fit(trial.motion.time, trial.force, fit.fitted, label, trial.used),
        )
