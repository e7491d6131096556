"""``nrs-design identify tissue``: a tissue law from records of force and deflection."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from functools import partial
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.options import Date, ReportTo
from nrs_design.cli.printing import detail, progress, say, wants_details
from nrs_design.identification.cli.identify.common import (
    ColumnMap,
    CoversOption,
    DataFiles,
    Replace,
    WriteTo,
    deliver,
    print_fits,
    read_all,
)
from nrs_design.identification.facts.tissue import tissue_facts
from nrs_design.models.contact import LAWS
from nrs_design.proof.text import counted

if TYPE_CHECKING:
    from nrs_design.identification.tissue.identify import TissueIdentification
    from nrs_design.identification.tissue.output_error import RecordFit
    from nrs_design.identification.tissue.tangent import Tangent


class ModelOption(StrEnum):
    """Laws by name, from their table."""

    _ignore_ = "law"
    AUTO = "auto"
    for law in LAWS:
        vars()[law.replace("-", "_").upper()] = law


Model = Annotated[ModelOption, typer.Option(help="Law to choose; auto compares them all.")]
Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="NAME=VALUE",
        help="What is used of a record: start, end (s), contact (auto, given), zero, tare (fit, or "
        "such as '0.1 m', '-1.3 N'), drift (auto, fit, none), skip_cycles, negate (true).",
    ),
]
Covers = Annotated[
    CoversOption,
    typer.Option(help="What the range holds: the mean, 95 % of specimens, or the next one."),
]
Preload = Annotated[
    str | None,
    typer.Option(metavar="LOW..HIGH", help="Deflections of a power law, as in '1 mm..3 mm'."),
]
Prony = Annotated[
    bool, typer.Option("--prony", help="Fit a Prony series, too: is one relaxation enough?")
]
LeverArm = Annotated[
    str | None,
    typer.Option(metavar="LENGTH", help="Distance from pivot to contact, as in '0.24 m'."),
]
EnvironmentName = Annotated[
    str | None, typer.Option(metavar="NAME", help="Environment of the spec to write to.")
]


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
    replace: Replace = False,
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
    from nrs_design.identification.datasets.records import read_tissue
    from nrs_design.identification.lever import parse_arm, parse_preload
    from nrs_design.identification.reporting.tissue import tissue_report
    from nrs_design.identification.tissue.identify import identify_tissue
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
        series = [fit_series(fit.trial) for fit in found.chosen.fits] if prony else None
    texts = [item.text(rotational=found.rotational) for item in series or ()]
    return deliver(
        outputs,
        found,
        partial(tissue_facts, arm=arm, series=series),
        partial(_print, arm=arm, texts=texts),
        partial(tissue_report, arm=arm, series=texts),
        partial(merge_tissue, environment=environment, arm=lever_arm, replace=replace),
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
    from nrs_design.identification.tissue.offsets import OFFSET_UNITS, OFFSET_WORDS

    texts = []
    for offset in fit.offsets:
        value = str(offset.estimate) if offset.fitted else f"{offset.estimate.value:.5g}"
        rest = f" ({offset.provided})" if offset.provided else "" if offset.fitted else " (given)"
        unit = OFFSET_UNITS[offset.name][rotational]
        texts.append(f"{OFFSET_WORDS[offset.name]} {value} {unit}{rest}")
    return texts
