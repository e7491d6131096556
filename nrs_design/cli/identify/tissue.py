"""``nrs-design identify tissue``: a tissue law from records of force and deflection."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.identify.common import (
    SYNTHETIC,
    ColumnMap,
    DataFiles,
    ReportTo,
    WriteTo,
    check_report,
    interval,
    numbers,
    read_all,
    sources,
    write_report,
    write_spec,
)
from nrs_design.cli.options import Date, Json, Quiet
from nrs_design.cli.printing import note, print_json, progress, say
from nrs_design.cli.tables import print_table

if TYPE_CHECKING:
    from nrs_design.identification.tissue import ModelFit, RecordFit, TissueIdentification
    from nrs_design.identification.tissue.prony import Series
    from nrs_design.identification.tissue.tangent import Tangent


class ModelOption(StrEnum):
    """Laws by name."""

    AUTO = "auto"
    ELASTIC = "elastic"
    KELVIN_VOIGT = "kelvin-voigt"
    MAXWELL = "maxwell"
    KELVIN_BOLTZMANN = "kelvin-boltzmann"
    HUNT_CROSSLEY = "hunt-crossley"


class ContactOption(StrEnum):
    """Whether air is looked for."""

    AUTO = "auto"
    GIVEN = "given"


class DriftOption(StrEnum):
    """Whether the tare of the force moves."""

    AUTO = "auto"
    FIT = "fit"
    NONE = "none"


class CoversOption(StrEnum):
    """What the range in a spec holds."""

    CONFIDENCE = "confidence"
    TOLERANCE = "tolerance"
    PREDICTION = "prediction"


def tissue(
    data: DataFiles,
    model: Annotated[
        ModelOption, typer.Option(help="Law to choose; auto compares them all.")
    ] = ModelOption.AUTO,
    columns: ColumnMap = None,
    start: Annotated[
        float | None, typer.Option("--from", metavar="S", help="First second that is used.")
    ] = None,
    end: Annotated[
        float | None, typer.Option("--to", metavar="S", help="Last second that is used.")
    ] = None,
    contact: Annotated[
        ContactOption,
        typer.Option(help="Find air and touches, or take the whole record as in contact."),
    ] = ContactOption.AUTO,
    zero: Annotated[
        str, typer.Option(metavar="POSITION", help="Position of contact, as in '0.1 m'.")
    ] = "fit",
    tare: Annotated[
        str, typer.Option(metavar="FORCE", help="Force in air, as in '-1.3 N' (or N*m).")
    ] = "fit",
    drift: Annotated[
        DriftOption, typer.Option(help="Let the tare move with time; auto asks the air.")
    ] = DriftOption.AUTO,
    skip_cycles: Annotated[
        int, typer.Option(min=0, metavar="N", help="First loading cycles to set apart.")
    ] = 0,
    negate_force: Annotated[
        bool, typer.Option("--negate-force", help="Change the sign of the force.")
    ] = False,
    covers: Annotated[
        CoversOption,
        typer.Option(help="What the range holds: the mean, 95 % of specimens, or the next one."),
    ] = CoversOption.CONFIDENCE,
    preload: Annotated[
        str | None,
        typer.Option(metavar="LOW..HIGH", help="Linearize about deflections, as in '1 mm..3 mm'."),
    ] = None,
    prony: Annotated[
        bool, typer.Option("--prony", help="Fit a Prony series, too: is one relaxation enough?")
    ] = False,
    lever_arm: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Distance from pivot to contact, as in '0.24 m'."),
    ] = None,
    write: WriteTo = None,
    environment: Annotated[
        str | None, typer.Option(metavar="NAME", help="Environment of the spec to write to.")
    ] = None,
    report: ReportTo = None,
    date: Date = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Fit five tissue laws to one or several records, compare them and choose one.

    Columns: time_s, deflection_m, force_N, or time_s, angle_rad, torque_Nm (mm, mN, deg, ms and
    the like are converted). One file is one record; the spread between records goes into the
    intervals. Air before, between and after touches is found, and so are a rupture and what follows
    it. The position of contact and the force in air are fitted with the law, unless they are given.
    What the fit leaves in doubt is written into the spec, and the gate fails on it until
    accept_doubt says why the range is used.

    Example: nrs-design identify tissue specs/data/silicone-soft-*.csv --lever-arm '0.24 m'
    """
    from nrs_design.identification.datasets import read_tissue
    from nrs_design.identification.lever import parse_arm, parse_offset, parse_preload
    from nrs_design.identification.tissue import Preparation, identify_tissue
    from nrs_design.identification.write_spec import merge_tissue
    from nrs_design.spec import read_spec

    check_report(report)
    loaded = read_spec(write) if write is not None else None
    records = read_all(data, read_tissue, columns or [], quiet=quiet)
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
    with progress("fitting", quiet=quiet) as step:
        found = identify_tissue(
            records,
            None if model is ModelOption.AUTO else str(model),
            preparation,
            covers.value,
            parse_preload(preload, rotational=rotational),
            progress=step,
        )
        series = _series(found) if prony else []
        merged = merge_tissue(loaded, found, environment, lever_arm) if loaded else None
        if report is not None:
            from nrs_design.reporting.identification import tissue_report

            step("figures")
            write_report(report, tissue_report(found, arm), date)
    if write is not None and merged is not None:
        write_spec(write, merged, quiet=quiet)
        # A proof will rest on these values: no option silences this.
        for caveat in found.caveats:
            note(f"warning: {caveat}")
    if as_json:
        listed = {"prony": [_series_summary(item) for item in series]} if prony else {}
        print_json("identify-tissue", _summary(found, arm) | listed)
    elif not quiet:
        _print(found, arm)
        for item in series:
            say(_series_text(item, found.rotational))
    if report is not None:
        note(f"page written to {report}", quiet=quiet)


def _print(found: TissueIdentification, arm: float | None) -> None:
    from nrs_design.identification.lever import units_of

    if found.synthetic:
        say(SYNTHETIC)
    least = min(model.bic for model in found.models)
    unit = "N m" if found.rotational else "N"
    rows = [
        [
            model.law.name,
            "\n".join(_parameters(model, units_of(model.law, found.rotational))),
            ", ".join(f"{value:.4g}" for value in model.rmse),
            f"{model.bic - least:.4g}",
            "; ".join(model.doubts[:2]) + (" ..." if len(model.doubts) > 2 else ""),
        ]
        for model in found.models
    ]
    columns = ["law", "pooled parameters [95 %]", f"RMSE {unit}", "BIC - least", "doubts"]
    print_table("", columns, rows)
    say(found.reason)
    law = found.chosen.law
    units = units_of(law, found.rotational)
    ranges = zip(law.parameters(), found.chosen.ranges, units, strict=True)
    for name, estimate, unit in ranges:
        say(f"{name} = {interval(estimate)} {unit} holds {found.covers}")
    if found.tangent is not None:
        _print_tangent(found.tangent, found.rotational)
    if found.chosen.box:
        say(found.chosen.box)
    for fit in found.chosen.fits:
        remarks = (*_offsets(fit, found.rotational), *fit.trial.remarks)
        say(f"{fit.record.name}: {'; '.join(remarks)}")
    if arm is not None:
        turned = law.at_pivot(arm)
        values = zip(law.parameters(), turned.values, units_of(law, True), strict=True)
        say(f"at the pivot: {', '.join(f'{n} = {v:.6g} {u}' for n, v, u in values)}")


def _series(found: TissueIdentification) -> list[Series]:
    from nrs_design.identification.tissue.prony import fit_series

    return [fit_series(trial) for trial in found.trials]


def _series_text(series: Series, rotational: bool) -> str:
    unit = "N m/rad" if rotational else "N/m"
    arms = ", ".join(
        f"{arm:.4g} {unit} in {tau:.4g} s"
        for arm, tau in zip(series.arms, series.times, strict=True)
    )
    text = f"{series.record}: Prony series of {len(series.arms)}: {series.rest:.4g} {unit} at rest"
    text += f", relaxing {arms}; RMSE {series.rmse:.4g}"
    if series.reduced is None:
        return text
    law = series.reduced
    values = zip(law.parameters(), law.values, strict=True)
    return f"{text}; as {law.name}: {', '.join(f'{name} = {value:.5g}' for name, value in values)}"


def _series_summary(series: Series) -> dict[str, Any]:
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
    from nrs_design.identification.lever import units_of

    parts = zip(about.law.parameters(), about.ranges, units_of(about.law, rotational), strict=True)
    values = ", ".join(f"{name} = {interval(estimate)} {unit}" for name, estimate, unit in parts)
    length = "rad" if rotational else "m"
    say(f"small motions about {about.low:.5g} to {about.high:.5g} {length}: {values}")


def _offsets(fit: RecordFit, rotational: bool) -> list[str]:
    from nrs_design.identification.tissue import OFFSET_UNITS, OFFSET_WORDS

    texts = []
    for offset in fit.offsets:
        value = interval(offset.estimate) if offset.fitted else f"{offset.estimate.value:.5g}"
        rest = f" ({offset.provided})" if offset.provided else "" if offset.fitted else " (given)"
        unit = OFFSET_UNITS[offset.name][rotational]
        texts.append(f"{OFFSET_WORDS[offset.name]} {value} {unit}{rest}")
    return texts


def _parameters(model: ModelFit, units: tuple[str, ...]) -> list[str]:
    parts = zip(model.law.parameters(), model.estimates, units, strict=True)
    return [f"{name} {interval(estimate)} {unit}" for name, estimate, unit in parts]


def _summary(found: TissueIdentification, arm: float | None) -> dict[str, Any]:
    from nrs_design.identification.lever import units_of

    law = found.chosen.law
    return {
        "synthetic": found.synthetic,
        "records": sources(record.source for record in found.records),
        "chosen": law.name,
        "reason": found.reason,
        "caveats": list(found.caveats),
        "ranges": {
            name: numbers(estimate) | {"unit": unit}
            for name, estimate, unit in zip(
                law.parameters(),
                found.chosen.ranges,
                units_of(law, found.rotational),
                strict=True,
            )
        },
        "tangent": None
        if found.tangent is None
        else {
            "preload": [found.tangent.low, found.tangent.high],
            "ranges": {
                name: numbers(estimate)
                for name, estimate in zip(
                    found.tangent.law.parameters(), found.tangent.ranges, strict=True
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
    }


def _model(model: ModelFit, rotational: bool) -> dict[str, Any]:
    from nrs_design.identification.lever import units_of

    names = model.law.parameters()
    return {
        "law": model.law.name,
        "parameters": {
            name: numbers(estimate) | {"unit": unit}
            for name, estimate, unit in zip(
                names, model.estimates, units_of(model.law, rotational), strict=True
            )
        },
        "relaxation_time_s": model.law.relaxation_time,
        "aic": model.aic,
        "bic": model.bic,
        "doubts": list(model.doubts),
        "records": [
            {
                "parameters": {
                    name: numbers(estimate)
                    for name, estimate in zip(names, fit.estimates, strict=True)
                },
                "rmse": fit.rmse,
                "rmse_pooled": pooled,
                "aic": fit.aic,
                "bic": fit.bic,
                "offsets": {
                    offset.name: numbers(offset.estimate)
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
