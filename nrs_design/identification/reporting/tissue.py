"""Output of the identification of a tissue."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeVar

from nrs_design.identification.reporting.view import (
    Curve,
    Facts,
    FindingView,
    estimate_numbers,
    marked,
)
from nrs_design.identification.statistics import Estimate, span
from nrs_design.identification.tissue.identify import TissueIdentification
from nrs_design.identification.tissue.output_error import RecordFit
from nrs_design.identification.tissue.pool import ModelFit
from nrs_design.identification.tissue.problem import DRIFT, TARE, ZERO
from nrs_design.identification.tissue.tangent import Tangent
from nrs_design.models.contact import AbstractContactLaw
from nrs_design.proof.text import counted
from nrs_design.reporting.document import Bullets, Table
from nrs_design.reporting.formatting import list_first, number

T = TypeVar("T")

# Names of offsets, and their units for a linear motion and a rotation.
_OFFSETS = {
    ZERO: ("position of contact", ("m", "rad")),
    TARE: ("force in air", ("N", "N m")),
    DRIFT: ("drift of the force", ("N/s", "N m/s")),
}


def view_tissue(result: TissueIdentification, arm: float | None = None) -> FindingView:
    """Return the output for a tissue; with a lever arm in m, the law at the pivot, too."""
    model, law = result.model, result.model.law
    ranges = _parameter_rows(law, model.ranges, result.rotational)
    notes = list(_notes(result, arm))
    if law.relaxation_time is not None:
        notes.append(f"the force relaxes in {number(law.relaxation_time)} s at rest")
    return FindingView(
        result,
        kind="tissue",
        method=law.name,
        reason=result.reason,
        ranges={name: (estimate, unit) for name, estimate, unit in ranges},
        facts=_facts(result, arm),
        lines=(
            result.reason,
            *(f"{_parameter_text([row])} holds {result.covers}" for row in ranges),
            *notes,
        ),
        details=_record_texts(result),
        fits=_table(result),
        blocks=(_estimates(result), *_doubts(result)),
        title=f"Tissue law from {counted(len(result.records), 'record')}",
        claim=f"{law.formula} with {_parameter_text(ranges)}. {result.reason}",
        curves=lambda: _curves(result),
    )


def _parameter_rows(
    law: AbstractContactLaw, values: Iterable[T], rotational: bool
) -> list[tuple[str, T, str]]:
    """Return name, value and unit of each parameter of a law."""
    units = _units(law, rotational)
    return list(zip(law.parameters(), values, units, strict=True))


def _parameter_text(parameters: Iterable[tuple[str, object, str]]) -> str:
    """Write parameters with their values and units."""
    return ", ".join(f"{name} = {value} {unit}".rstrip() for name, value, unit in parameters)


def _units(law: AbstractContactLaw, rotational: bool) -> tuple[str, ...]:
    """Return the units of the parameters of a law, as people read them."""
    return tuple(unit.replace("*", " ") for unit in law.units(rotational=rotational))


def _notes(result: TissueIdentification, arm: float | None) -> Iterator[str]:
    """Yield the tangent, and the law at the pivot, in words."""
    law, tangent = result.model.law, result.tangent
    if tangent is not None:
        length = "rad" if result.rotational else "m"
        values = _parameter_text(_parameter_rows(tangent.law, tangent.ranges, result.rotational))
        yield f"small motions about {span(tangent.low, tangent.high, length, 5)}: {values}"
        *power, exponent = tangent.power
        values = _parameter_text(
            [*_parameter_rows(tangent.law, power, result.rotational), ("phi", exponent, "")]
        )
        yield f"the law itself, by its tangent at {tangent.operating_point:.5g} {length}: {values}"
    if arm is not None:
        pivot_values = [f"{value:.6g}" for value in law.convert_to_pivot(arm).values]
        yield f"at the pivot: {_parameter_text(_parameter_rows(law, pivot_values, True))}"


def _record_texts(result: TissueIdentification) -> tuple[str, ...]:
    """Return a line about samples and offsets for each record."""
    return tuple(
        "; ".join(
            (
                f"{fit.record.name}: {int(fit.trial.fit_mask.sum())} of "
                f"{counted(len(fit.record.force), 'sample')} used",
                *_offset_texts(fit, result.rotational),
                *fit.trial.remarks,
            )
        )
        for fit in result.model.fits
    )


def _offset_texts(fit: RecordFit, rotational: bool) -> Iterator[str]:
    for name, value in fit.offsets.items():
        words, units = _OFFSETS[name]
        condition = " if the force in air is zero" * (name == ZERO and TARE not in fit.offsets)
        yield f"{words} {value:.5g} {units[rotational]}{condition}"


def _table(result: TissueIdentification) -> Table:
    """Return how well each law describes the records."""
    records = [record.name for record in result.records]
    lowest = min(model.bic for model in result.models)
    rows = tuple(
        (
            marked(model.law.name, is_chosen=model is result.model),
            *(number(fit.rmse, 3) for fit in model.fits),
            number(model.bic - lowest),
            f"{min(fit.uncertainty.whiteness for fit in model.fits):.2g}",
            str(len(model.doubts)),
        )
        for model in result.models
    )
    unit = "N m" if result.rotational else "N"
    columns = ("Law", *records, "BIC - least", "White p", "Doubts")
    return Table(f"Comparison of laws by RMSE [{unit}] in each record", columns, rows)


def _facts(result: TissueIdentification, arm: float | None) -> Facts:
    law, tangent = result.model.law, result.tangent
    pivot_values = None if arm is None else law.convert_to_pivot(arm).values
    return {
        "chosen": law.name,
        "reason": result.reason,
        "ranges": _numbers(law, result.model.ranges, result.rotational),
        "tangent": None if tangent is None else _tangent(tangent, result.rotational),
        "range_covers": result.model.coverage,
        "range_covers_words": result.covers,
        "at_pivot": pivot_values and dict(zip(law.parameters(), pivot_values, strict=True)),
        "models": [_model(model, result.rotational) for model in result.models],
    }


def _numbers(law: AbstractContactLaw, estimates: Iterable[Estimate], rotational: bool) -> Facts:
    return {
        name: estimate_numbers(estimate) | {"unit": unit}
        for name, estimate, unit in _parameter_rows(law, estimates, rotational)
    }


def _tangent(tangent: Tangent, rotational: bool) -> Facts:
    *power, exponent = tangent.power
    law = _numbers(tangent.law, power, rotational) | {"phi": estimate_numbers(exponent)}
    return {
        "preload": [tangent.low, tangent.high],
        "ranges": _numbers(tangent.law, tangent.ranges, rotational),
        "about": tangent.operating_point,
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
        "offsets": fit.offsets,
        "used": int(fit.trial.fit_mask.sum()),
        "samples": len(fit.record.force),
        "cuts": list(fit.trial.cuts),
        "remarks": list(fit.trial.remarks),
        "r2": fit.r2,
        "residual_over_range": fit.rmse / fit.trial.span,
        "whiteness_p": fit.uncertainty.whiteness,
    }


def _doubts(result: TissueIdentification) -> Iterator[Bullets]:
    doubts = tuple(
        f"{model.law.name}: {list_first(model.doubts, 4)}."
        for model in result.models
        if model.doubts
    )
    if doubts:
        yield Bullets("Doubts: what the records do not determine", doubts)


def _estimates(result: TissueIdentification) -> Table:
    model, law = result.model, result.model.law
    units = _units(law, result.rotational)
    names = (f"{n} [{u or '1'}]" for n, u in zip(law.parameters(), units, strict=True))
    rows = (
        *((fit.record.name, *map(str, fit.estimates)) for fit in model.fits),
        ("pooled", *map(str, model.estimates)),
        (f"range: {result.covers}", *map(str, model.ranges)),
    )
    return Table("Estimates of the chosen law [95 % interval]", ("Record", *names), rows)


def _curves(result: TissueIdentification) -> Iterator[Curve]:
    label = "Torque [N m]" if result.rotational else "Force [N]"
    for fit in result.model.fits:
        trial, white = fit.trial, f"whiteness p = {fit.uncertainty.whiteness:.2g}"
        note = f"Fit to this record alone: RMSE {number(fit.rmse)}, {white}."
        data = (trial.motion.time, trial.force, fit.fitted, trial.fit_mask)
        yield Curve(fit.record.name, note, label, *data)
