"""``nrs-design identify tissue``: a tissue law from records of force and deflection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.options import Date, ReportTo
from nrs_design.cli.printing import progress, say
from nrs_design.cli.tables import print_table
from nrs_design.identification.cli.identify.common import (
    ColumnMap,
    CoversOption,
    DataFiles,
    Facts,
    WriteTo,
    deliver,
    estimate_numbers,
    read_all,
)
from nrs_design.identification.cli.identify.tissue_options import (
    Contact,
    ContactOption,
    Covers,
    Drift,
    DriftOption,
    End,
    EnvironmentName,
    LeverArm,
    Model,
    ModelOption,
    NegateForce,
    Preload,
    Prony,
    SkipCycles,
    Start,
    Tare,
    Zero,
)

if TYPE_CHECKING:
    from nrs_design.identification.tissue import ModelFit, RecordFit, TissueIdentification
    from nrs_design.identification.tissue.prony import Series
    from nrs_design.identification.tissue.tangent import Tangent
    from nrs_design.reporting import Report


@command("identify-tissue")
def tissue(
    data: DataFiles,
    model: Model = ModelOption.AUTO,
    columns: ColumnMap = None,
    start: Start = None,
    end: End = None,
    contact: Contact = ContactOption.AUTO,
    zero: Zero = "fit",
    tare: Tare = "fit",
    drift: Drift = DriftOption.AUTO,
    skip_cycles: SkipCycles = 0,
    negate_force: NegateForce = False,
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
    it. The position of contact and the force in air are fitted with the law, unless they are given.
    --write keeps the law of the environment, unless --model names another.
    What the fit leaves in doubt is written into the spec, and the gate fails on it until
    accept_doubt says why the range is used.

    Example: nrs-design identify tissue specs/data/silicone-soft-*.csv --lever-arm '0.24 m'
    """
    from nrs_design.identification.datasets import read_tissue
    from nrs_design.identification.lever import parse_arm, parse_offset, parse_preload
    from nrs_design.identification.tissue import Preparation, identify_tissue
    from nrs_design.identification.write_spec import law_to_write, merge_tissue

    outputs = Destinations.checked(write, report, date)
    records = read_all(data, read_tissue, columns or [])
    rotational = any(record.rotational for record in records)
    arm = parse_arm(lever_arm, rotational=rotational)
    preparation = Preparation(
        start=start,
        end=end,
        contact=contact.value,
        zero=parse_offset("--zero", zero, rotational=rotational),
        tare=parse_offset("--tare", tare, rotational=rotational),
        drift=drift.value,
        skip_cycles=skip_cycles,
        negate=negate_force,
    )
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
        series = _series(found) if prony else None
    return deliver(
        outputs,
        found,
        lambda: _facts(found, arm, series),
        lambda: _print(found, arm, series or []),
        lambda: _page(found, arm, series or []),
        lambda spec: merge_tissue(spec, found, environment, lever_arm),
    )


def _page(found: TissueIdentification, arm: float | None, series: list[Series]) -> Report:
    from nrs_design.identification.reporting.tissue import tissue_report

    return tissue_report(found, arm, [item.text(rotational=found.rotational) for item in series])


def _print(found: TissueIdentification, arm: float | None, series: list[Series]) -> None:
    from nrs_design.identification.lever import parameter_units

    least = min(model.bic for model in found.models)
    unit = "N m" if found.rotational else "N"
    rows = [
        [
            model.law.name,
            "\n".join(_parameters(model, parameter_units(model.law, found.rotational))),
            ", ".join(f"{value:.4g}" for value in model.rmse),
            f"{model.bic - least:.4g}",
            doubts_of(model, chosen=model is found.chosen),
        ]
        for model in found.models
    ]
    columns = ["law", "pooled parameters [95 %]", f"RMSE {unit}", "BIC - least", "doubts"]
    print_table("", columns, rows)
    say(found.reason)
    law = found.chosen.law
    units = parameter_units(law, found.rotational)
    ranges = zip(law.parameters(), found.chosen.ranges, units, strict=True)
    for name, estimate, unit in ranges:
        say(f"{name} = {estimate} {unit} holds {found.covers}")
    if found.tangent is not None:
        _print_tangent(found.tangent, found.rotational)
    if found.chosen.box:
        say(found.chosen.box)
    for fit in found.chosen.fits:
        remarks = (*_offsets(fit, found.rotational), *fit.trial.remarks)
        say(f"{fit.record.name}: {'; '.join(remarks)}")
    if arm is not None:
        turned = law.at_pivot(arm)
        values = zip(law.parameters(), turned.values, parameter_units(law, True), strict=True)
        say(f"at the pivot: {', '.join(f'{n} = {v:.6g} {u}' for n, v, u in values)}")
    for item in series:
        say(item.text(rotational=found.rotational))


def doubts_of(model: ModelFit, *, chosen: bool) -> str:
    """Join the doubts about a law: all of the chosen one, the first two of others."""
    shown = model.doubts if chosen else model.doubts[:2]
    return "; ".join(shown) + (" ..." if len(model.doubts) > len(shown) else "")


def _series(found: TissueIdentification) -> list[Series]:
    from nrs_design.identification.tissue.prony import fit_series

    return [fit_series(trial) for trial in found.trials]


def _series_summary(series: Series) -> Facts:
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


def _print_tangent(about: Tangent, rotational: bool) -> None:
    from nrs_design.identification.lever import parameter_units
    from nrs_design.identification.statistics import span

    parts = zip(
        about.law.parameters(), about.ranges, parameter_units(about.law, rotational), strict=True
    )
    values = ", ".join(f"{name} = {estimate} {unit}" for name, estimate, unit in parts)
    length = "rad" if rotational else "m"
    say(f"small motions about {span(about.low, about.high, length, 5)}: {values}")
    names = (*about.law.parameters(), "phi")
    units = (*parameter_units(about.law, rotational), "")
    power = ", ".join(
        f"{name} = {estimate} {unit}".rstrip()
        for name, estimate, unit in zip(names, about.power, units, strict=True)
    )
    say(f"the law itself, by its tangent at {about.about:.5g} {length}: {power}")


def _offsets(fit: RecordFit, rotational: bool) -> list[str]:
    from nrs_design.identification.tissue import OFFSET_UNITS, OFFSET_WORDS

    texts = []
    for offset in fit.offsets:
        value = str(offset.estimate) if offset.fitted else f"{offset.estimate.value:.5g}"
        rest = f" ({offset.provided})" if offset.provided else "" if offset.fitted else " (given)"
        unit = OFFSET_UNITS[offset.name][rotational]
        texts.append(f"{OFFSET_WORDS[offset.name]} {value} {unit}{rest}")
    return texts


def _parameters(model: ModelFit, units: tuple[str, ...]) -> list[str]:
    parts = zip(model.law.parameters(), model.estimates, units, strict=True)
    return [f"{name} {estimate} {unit}" for name, estimate, unit in parts]


def _facts(found: TissueIdentification, arm: float | None, series: list[Series] | None) -> Facts:
    from nrs_design.identification.lever import parameter_units

    law = found.chosen.law
    listed = {} if series is None else {"prony": [_series_summary(item) for item in series]}
    return {
        "chosen": law.name,
        "reason": found.reason,
        "ranges": {
            name: estimate_numbers(estimate) | {"unit": unit}
            for name, estimate, unit in zip(
                law.parameters(),
                found.chosen.ranges,
                parameter_units(law, found.rotational),
                strict=True,
            )
        },
        "tangent": None
        if found.tangent is None
        else {
            "preload": [found.tangent.low, found.tangent.high],
            "ranges": {
                name: estimate_numbers(estimate)
                for name, estimate in zip(
                    found.tangent.law.parameters(), found.tangent.ranges, strict=True
                )
            },
            "about": found.tangent.about,
            "law": {
                name: estimate_numbers(estimate)
                for name, estimate in zip(
                    (*found.tangent.law.parameters(), "phi"), found.tangent.power, strict=True
                )
            },
        },
        "range_covers": found.chosen.coverage,
        "range_covers_words": found.covers,
        "box": found.chosen.box or None,
        "at_pivot": None
        if arm is None
        else dict(zip(law.parameters(), law.at_pivot(arm).values, strict=True)),
        "models": [_model(model, found.rotational) for model in found.models],
        **listed,
    }


def _model(model: ModelFit, rotational: bool) -> Facts:
    from nrs_design.identification.lever import parameter_units

    names = model.law.parameters()
    return {
        "law": model.law.name,
        "parameters": {
            name: estimate_numbers(estimate) | {"unit": unit}
            for name, estimate, unit in zip(
                names, model.estimates, parameter_units(model.law, rotational), strict=True
            )
        },
        "relaxation_time_s": model.law.relaxation_time,
        "aic": model.aic,
        "bic": model.bic,
        "doubts": list(model.doubts),
        "records": [
            {
                "parameters": {
                    name: estimate_numbers(estimate)
                    for name, estimate in zip(names, fit.estimates, strict=True)
                },
                "rmse": fit.rmse,
                "rmse_pooled": pooled,
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
            for fit, pooled in zip(model.fits, model.rmse, strict=True)
        ],
    }
