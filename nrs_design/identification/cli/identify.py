"""``nrs-design identify``: measured data in, models with intervals out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import StrEnum
from functools import partial
from pathlib import Path
from typing import Annotated, TypeVar

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import Date
from nrs_design.cli.printing import progress
from nrs_design.errors import SpecError
from nrs_design.identification.cli.destinations import Destinations
from nrs_design.identification.errors import DataError
from nrs_design.models.contact import LAWS
from nrs_design.spec.kinds import ANGLE, LENGTH, LEVER_ARM
from nrs_design.spec.provenance import Coverage
from nrs_design.spec.quantity import QuantityKind, parse_quantity

DataFiles = Annotated[list[Path], typer.Argument(metavar="DATA...", help="Files of data.")]
ColumnMap = Annotated[
    list[str] | None,
    typer.Option("--map", metavar="OURS=THEIRS", help="Foreign column name, as in force_N=Fz."),
]
SpecOption = Annotated[
    Path | None,
    typer.Option("--write", metavar="SPEC", help="Merge the result into this spec file."),
]
ReportFile = Annotated[
    Path | None, typer.Option("--report", metavar="FILE", help="Write a page with figures (.html).")
]

# In m; longer arms were meant in mm.
_LONGEST_ARM = 10.0


class ModelOption(StrEnum):
    """Laws by name, from their table."""

    _ignore_ = "law"
    AUTO = "auto"
    for law in LAWS:
        vars()[law.replace("-", "_").upper()] = law


T = TypeVar("T")

identify = typer.Typer(
    no_args_is_help=True,
    help="Identify actuator, tissue or delay from measured records, with 95 % intervals.",
    epilog="Data are text (CSV and the like), with columns named by quantity and unit, "
    "such as time_s, deflection_m, 'Force [N]'; --map names others.",
)


def read_all(
    paths: Sequence[Path], read: Callable[[Path, dict[str, str]], T], entries: Sequence[str]
) -> list[T]:
    """Read every file, with columns named as the user said."""
    from nrs_design.identification.tables.columns import parse_mapping

    mapping = parse_mapping(entries)
    with progress("reading"):
        return [read(path, mapping) for path in paths]


@identify.command("tissue")
@command("identify-tissue")
def tissue(
    data: DataFiles,
    model: Annotated[
        ModelOption, typer.Option(help="Law to choose; auto compares them all.")
    ] = ModelOption.AUTO,
    columns: ColumnMap = None,
    settings: Annotated[
        list[str] | None,
        typer.Option(
            "--set",
            metavar="NAME=VALUE",
            help="What is used of a record: start, end (s), contact (auto, given), negate (true).",
        ),
    ] = None,
    coverage: Annotated[
        Coverage,
        typer.Option(
            "--covers", help="What the range holds: the mean, 95 % of specimens, or the next one."
        ),
    ] = "confidence",
    preload: Annotated[
        str | None,
        typer.Option(metavar="LOW..HIGH", help="Deflections of a power law, as in '1 mm..3 mm'."),
    ] = None,
    lever_arm: Annotated[
        str | None,
        typer.Option(metavar="LENGTH", help="Distance from pivot to contact, as in '0.24 m'."),
    ] = None,
    write: SpecOption = None,
    environment: Annotated[
        str | None, typer.Option(metavar="NAME", help="Environment of the spec to write to.")
    ] = None,
    report: ReportFile = None,
    date: Date = None,
) -> Answer:
    """Fit five tissue laws to one or several records, compare them and choose one.

    Columns: time_s, deflection_m, force_N, or time_s, angle_rad, torque_Nm (mm, mN, deg, ms and
    the like are converted). One file is one record; the spread between records goes into the
    intervals. Air before, between and after touches is found. The position of contact and the
    force in air are fitted with the law.
    --write keeps the law of the environment, unless --model names another.
    What the fit leaves in doubt is written into the spec, and the gate fails on it until
    accept_doubt says why the range is used.

    Example: nrs-design identify tissue specs/data/silicone-soft-*.csv --lever-arm '0.24 m'
    """
    from nrs_design.identification.datasets.records import read_tissue
    from nrs_design.identification.reporting.tissue import view_tissue
    from nrs_design.identification.tissue.identify import identify_tissue
    from nrs_design.identification.tissue.settings import read_preparation
    from nrs_design.identification.write_spec import law_to_write, merge_tissue

    outputs = Destinations.checked(write, report, date)
    records = read_all(data, read_tissue, columns or [])
    rotational = any(record.rotational for record in records)
    arm = parse_arm(lever_arm, rotational=rotational)
    preparation = read_preparation(settings or ())
    deflections = parse_preload(preload, rotational=rotational)
    law = requested = None if model is ModelOption.AUTO else str(model)
    if outputs.spec is not None:
        law = law_to_write(outputs.spec, environment, requested)
    elif environment is not None:
        raise typer.BadParameter("name a spec by --write, too", param_hint="--environment")
    with progress("fitting") as step:
        result = identify_tissue(
            records,
            law,
            preparation,
            coverage,
            deflections,
            progress=step,
            is_declared=requested is None,
        )
    view = view_tissue(result, arm)
    return outputs.deliver(view, lambda spec: merge_tissue(spec, result, environment, lever_arm))


@identify.command("actuator")
@command("identify-actuator")
def actuator(
    data: DataFiles,
    columns: ColumnMap = None,
    write: SpecOption = None,
    report: ReportFile = None,
    date: Date = None,
) -> Answer:
    """Fit gain, time constant, Coulomb friction and dead time of a motor that follows a velocity.

    Columns: time_s, command_rpm (or _V, _A, _counts), and angle_rad or velocity_rad_s; any command
    that moves the motor: sinusoids, steps, stairs, chirps, random ones, in open or closed loop.
    One file is one record.

    Example: nrs-design identify actuator specs/data/actuator-*hz.csv --report reports/actuator.html
    """
    from nrs_design.identification.actuator.identify import identify_actuator
    from nrs_design.identification.datasets.records import read_actuator
    from nrs_design.identification.reporting.actuator import view_actuator
    from nrs_design.identification.write_spec import merge_actuator

    outputs = Destinations.checked(write, report, date)
    records = read_all(data, read_actuator, columns or [])
    with progress("fitting"):
        result = identify_actuator(records)
    view = view_actuator(result)
    return outputs.deliver(view, partial(merge_actuator, result=result))


@identify.command("delay")
@command("identify-delay")
def delay(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Record of a running loop.")],
    command: Annotated[str, typer.Option(metavar="COLUMN", help="What was sent.")],
    measured: Annotated[str, typer.Option(metavar="COLUMN", help="What follows.")],
    columns: ColumnMap = None,
    write: SpecOption = None,
    report: ReportFile = None,
    date: Date = None,
) -> Answer:
    """Find how late a measured signal follows a command, in seconds and in samples.

    Cross-correlation first, then a fit of the delay beside what it must not be mistaken for: a
    copy, a lag of first or second order, a lag with an integrator; the simplest decides that no
    other beats by 10 in BIC. The interval is at 95 %; parts of the record show whether the delay
    varies. --write is for two forces, the one that the sensor measured and the one that the law
    used: its age is the delay of sampling.

    Example: nrs-design identify delay run.csv --command force_raw --measured force_used
    """
    from nrs_design.identification.datasets.records import read_signals
    from nrs_design.identification.delay.identify import identify_delay
    from nrs_design.identification.reporting.delay import view_delay
    from nrs_design.identification.write_spec import merge_sampling

    if command == measured:
        raise typer.BadParameter("name two columns", param_hint="--command, --measured")
    outputs = Destinations.checked(write, report, date)
    entries = [*(columns or []), f"input_any={command}", f"output_any={measured}"]
    (record,) = read_all([log], read_signals, entries)
    with progress("fitting"):
        result = identify_delay(record)
    view = view_delay(result)
    return outputs.deliver(view, partial(merge_sampling, result=result))


def parse_arm(text: str | None, *, rotational: bool) -> float | None:
    """Read a lever arm such as ``0.24 m``; return it in m. Records of a rotation need none."""
    if text is None:
        return None
    arm = _parse("--lever-arm", text, LEVER_ARM)
    if rotational:
        raise DataError(
            "the records are rotational, and a lever arm is given", remedy="remove --lever-arm"
        )
    if arm <= 0:
        raise DataError(f"the lever arm {text!r} is not positive", remedy="write '0.24 m'")
    if arm > _LONGEST_ARM:
        raise DataError(
            f"the lever arm {text!r} is longer than any arm", remedy=f"did you mean '{arm:g} mm'?"
        )
    return arm


def parse_preload(text: str | None, *, rotational: bool) -> tuple[float, float] | None:
    """Read ``--preload``, such as ``1 mm..3 mm``: deflections from the contact, in SI."""
    if text is None:
        return None
    low, dots, high = (part.strip() for part in text.partition(".."))
    if not dots:
        high = low
    kind = ANGLE if rotational else LENGTH
    return _parse("--preload", low, kind), _parse("--preload", high, kind)


def _parse(option: str, text: str, kind: QuantityKind) -> float:
    try:
        return parse_quantity(text, kind).si
    except SpecError as error:
        raise DataError(f"{option}: {error.message}", remedy=error.remedy) from None
