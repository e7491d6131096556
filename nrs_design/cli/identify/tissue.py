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
    from nrs_design.identification.tissue import ModelFit, TissueIdentification


class ModelOption(StrEnum):
    """Laws by name."""

    AUTO = "auto"
    ELASTIC = "elastic"
    KELVIN_VOIGT = "kelvin-voigt"
    MAXWELL = "maxwell"
    KELVIN_BOLTZMANN = "kelvin-boltzmann"
    HUNT_CROSSLEY = "hunt-crossley"


def tissue(
    data: DataFiles,
    model: Annotated[
        ModelOption, typer.Option(help="Law to choose; auto compares them all.")
    ] = ModelOption.AUTO,
    columns: ColumnMap = None,
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
    intervals.

    Example: nrs-design identify tissue specs/data/silicone-soft-*.csv --lever-arm '0.24 m'
    """
    from nrs_design.identification.datasets import read_tissue
    from nrs_design.identification.lever import parse_arm
    from nrs_design.identification.tissue import identify_tissue
    from nrs_design.identification.write_spec import merge_tissue
    from nrs_design.spec import read_spec

    check_report(report)
    loaded = read_spec(write) if write is not None else None
    records = read_all(data, read_tissue, columns or [], quiet=quiet)
    arm = parse_arm(lever_arm, rotational=any(record.rotational for record in records))
    with progress("fitting", quiet=quiet) as step:
        found = identify_tissue(records, None if model is ModelOption.AUTO else str(model), step)
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
        print_json("identify-tissue", _summary(found, arm))
    elif not quiet:
        _print(found, arm)
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
        say(f"{name} = {interval(estimate)} {unit} covers the pooled interval and every record")
    if arm is not None:
        turned = law.at_pivot(arm)
        values = zip(law.parameters(), turned.values, units_of(law, True), strict=True)
        say(f"at the pivot: {', '.join(f'{n} = {v:.6g} {u}' for n, v, u in values)}")


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
                "whiteness_p": fit.uncertainty.whiteness,
                "starts": fit.starts,
                "agreeing": fit.agreeing,
            }
            for fit, pooled in zip(model.fits, model.rmse, strict=True)
        ],
    }
