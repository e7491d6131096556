"""``nrs-design identify tissue``: a tissue law from records of force and deflection."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.options import Date, ReportTo
from nrs_design.cli.printing import detail, progress, say, wants_details
from nrs_design.identification.cli.identify.common import (
    ColumnMap,
    CoversOption,
    DataFiles,
    Facts,
    WriteTo,
    deliver,
    estimate_numbers,
    print_fits,
    read_all,
)
from nrs_design.identification.cli.identify.tissue_options import (
    Covers,
    EnvironmentName,
    LeverArm,
    Model,
    ModelOption,
    Preload,
    Prony,
    Settings,
)
from nrs_design.proof.text import counted

if TYPE_CHECKING:
    from nrs_design.identification.statistics import Estimate
    from nrs_design.identification.tissue import ModelFit, RecordFit, TissueIdentification
    from nrs_design.identification.tissue.prony import Series
    from nrs_design.identification.tissue.tangent import Tangent
    from nrs_design.models.contact import AbstractContactLaw


@command("identify-tissue")
def tissue(
    data: DataFiles,
    model: Model = ModelOption.AUTO,
    columns: ColumnMap = None,
    settings: Settings = None,
    covers: Covers = CoversOption.CONFIDENCE,
    preload: Preload = None,
    prony: Prony = False,
    lever_arm: LeverArm = None,
    write: WriteTo = None,
    environment: EnvironmentName = None,
    report: ReportTo = None,
    date: Date = None,
) -> Answer:
    """Fit five tissue laws to one or several records, compare them and choose one.

    Columns: time_s, deflection_m, force_N, or time_s, angle_rad, torque_Nm (mm, mN, deg, ms and
    the like are converted). One file is one record; the spread between records goes into the
    intervals. Air before, between and after touches is found, and so are a rupture and what follows
    it. The position of contact and the force in air are fitted with the law, unless --set gives
    them.
    --write keeps the law of the environment, unless --model names another.
    What the fit leaves in doubt is written into the spec, and the gate fails on it until
    accept_doubt says why the range is used.

    Example: nrs-design identify tissue specs/data/silicone-soft-*.csv --lever-arm '0.24 m'
    """
    from nrs_design.identification.datasets import read_tissue
    from nrs_design.identification.lever import parse_arm, parse_preload
    from nrs_design.identification.reporting.tissue import tissue_report
    from nrs_design.identification.tissue import identify_tissue
    from nrs_design.identification.tissue.preparation_settings import read_preparation
    from nrs_design.identification.tissue.prony import fit_series
    from nrs_design.identification.write_spec import law_to_write, merge_tissue

    outputs = Destinations.checked(write, report, date)
    records = read_all(data, read_tissue, columns or [])
    rotational = any(record.rotational for record in records)
    arm = parse_arm(lever_arm, rotational=rotational)
    preparation = read_preparation(settings or (), rotational=rotational)
    deflections = parse_preload(preload, rotational=rotational)
    law = asked = None if model is ModelOption.AUTO else str(model)
    if outputs.spec is not None:
        law = law_to_write(
            outputs.spec,
            environment,
            lever_arm,
            asked,
            preloaded=deflections is not None,
            rotational=rotational,
        )
    elif environment is not None:
        raise typer.BadParameter("name a spec by --write, too", param_hint="--environment")
    with progress("fitting") as step:
        found = identify_tissue(
            records,
            law,
            preparation,
            covers.value,
            deflections,
            progress=step,
            declared=asked is None,
        )
        series = [fit_series(trial) for trial in found.trials] if prony else None
    texts = [item.text(rotational=found.rotational) for item in series or ()]
    return deliver(
        outputs,
        found,
        partial(_facts, arm=arm, series=series),
        partial(_print, arm=arm, texts=texts),
        partial(tissue_report, arm=arm, series=texts),
        partial(merge_tissue, environment=environment, arm=lever_arm),
    )


def _print(found: TissueIdentification, arm: float | None, texts: Sequence[str]) -> None:
    from nrs_design.identification.lever import in_words, named
    from nrs_design.identification.reporting.tissue import comparison

    print_fits(comparison(found))
    say(found.reason)
    law = found.chosen.law
    for parameter in named(law, found.chosen.ranges, found.rotational):
        say(f"{in_words([parameter])} holds {found.covers}")
    if found.tangent is not None:
        _print_tangent(found.tangent, found.rotational)
    if found.chosen.box:
        say(found.chosen.box)
    for fit in found.chosen.fits:
        remarks = (*_offsets(fit, found.rotational), *fit.trial.remarks)
        detail(f"{fit.record.name}: {'; '.join(remarks)}")
    remarked = sum(bool(fit.trial.remarks) for fit in found.chosen.fits)
    if not wants_details():
        said = f"{counted(remarked, 'record')} with remarks, " if remarked else ""
        say(f"{said}{counted(len(found.models), 'law')} compared (-v shows them)")
    if arm is not None:
        turned = [f"{value:.6g}" for value in law.at_pivot(arm).values]
        say(f"at the pivot: {in_words(named(law, turned, True))}")
    for text in texts:
        say(text)


def _print_tangent(about: Tangent, rotational: bool) -> None:
    from nrs_design.identification.lever import in_words, named
    from nrs_design.identification.statistics import span

    length = "rad" if rotational else "m"
    values = in_words(named(about.law, about.ranges, rotational))
    say(f"small motions about {span(about.low, about.high, length, 5)}: {values}")
    *power, exponent = about.power
    values = in_words([*named(about.law, power, rotational), ("phi", exponent, "")])
    say(f"the law itself, by its tangent at {about.about:.5g} {length}: {values}")


def _offsets(fit: RecordFit, rotational: bool) -> list[str]:
    from nrs_design.identification.tissue import OFFSET_UNITS, OFFSET_WORDS

    texts = []
    for offset in fit.offsets:
        value = str(offset.estimate) if offset.fitted else f"{offset.estimate.value:.5g}"
        rest = f" ({offset.provided})" if offset.provided else "" if offset.fitted else " (given)"
        unit = OFFSET_UNITS[offset.name][rotational]
        texts.append(f"{OFFSET_WORDS[offset.name]} {value} {unit}{rest}")
    return texts


def _facts(found: TissueIdentification, arm: float | None, series: list[Series] | None) -> Facts:
    law, about = found.chosen.law, found.tangent
    listed = {} if series is None else {"prony": [_series_facts(item) for item in series]}
    return {
        "chosen": law.name,
        "reason": found.reason,
        "ranges": _parameters(law, found.chosen.ranges, found.rotational),
        "tangent": None if about is None else _tangent(about, found.rotational),
        "range_covers": found.chosen.coverage,
        "range_covers_words": found.covers,
        "box": found.chosen.box or None,
        "at_pivot": None
        if arm is None
        else dict(zip(law.parameters(), law.at_pivot(arm).values, strict=True)),
        "models": [_model(model, found.rotational) for model in found.models],
        **listed,
    }


def _parameters(law: AbstractContactLaw, estimates: Iterable[Estimate], rotational: bool) -> Facts:
    from nrs_design.identification.lever import named

    return {
        name: estimate_numbers(estimate) | {"unit": unit}
        for name, estimate, unit in named(law, estimates, rotational)
    }


def _tangent(about: Tangent, rotational: bool) -> Facts:
    *power, exponent = about.power
    law = _parameters(about.law, power, rotational) | {"phi": estimate_numbers(exponent)}
    return {
        "preload": [about.low, about.high],
        "ranges": _parameters(about.law, about.ranges, rotational),
        "about": about.about,
        "law": law,
    }


def _series_facts(series: Series) -> Facts:
    law = series.reduced
    return {
        "record": series.record,
        "rest": series.rest,
        "arms": list(series.arms),
        "times_s": list(series.times),
        "rmse": series.rmse,
        "bic": list(series.bic),
        "reduced": None
        if law is None
        else {"law": law.name, **dict(zip(law.parameters(), law.values, strict=True))},
    }


def _model(model: ModelFit, rotational: bool) -> Facts:
    return {
        "law": model.law.name,
        "parameters": _parameters(model.law, model.estimates, rotational),
        "relaxation_time_s": model.law.relaxation_time,
        "aic": model.aic,
        "bic": model.bic,
        "doubts": list(model.doubts),
        "records": [
            _record(fit, rotational) | {"rmse_pooled": pooled}
            for fit, pooled in zip(model.fits, model.rmse, strict=True)
        ],
    }


def _record(fit: RecordFit, rotational: bool) -> Facts:
    return {
        "parameters": _parameters(fit.law, fit.estimates, rotational),
        "rmse": fit.rmse,
        "aic": fit.aic,
        "bic": fit.bic,
        "offsets": {
            offset.name: estimate_numbers(offset.estimate)
            | {"fitted": offset.fitted, "provided": offset.provided or None}
            for offset in fit.offsets
        },
        "used": int(fit.trial.used.sum()),
        "samples": len(fit.record.force),
        "cuts": list(map(str, fit.trial.cuts)),
        "remarks": list(fit.trial.remarks),
        "r2": fit.r2,
        "residual_over_range": fit.rmse / fit.trial.span,
        "whiteness_p": fit.uncertainty.whiteness,
        "starts": fit.starts,
        "agreeing": fit.agreeing,
    }
