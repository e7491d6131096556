"""``nrs-design identify delay``: how late a signal of a running loop comes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.identify.common import (
    SYNTHETIC,
    ColumnMap,
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
    from nrs_design.identification.delay import DelayIdentification

INPUT, OUTPUT = "input_any", "output_any"


def delay(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="Record of a running loop.")],
    command: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="What was sent; default: command_UNIT.")
    ] = None,
    measured: Annotated[
        str | None,
        typer.Option(metavar="COLUMN", help="What follows; default: angle, velocity or force."),
    ] = None,
    columns: ColumnMap = None,
    write: WriteTo = None,
    report: ReportTo = None,
    date: Date = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find how late a measured signal follows a command, in seconds and in samples.

    Cross-correlation first, then a fit of the delay beside what it must not be mistaken for: a
    copy, a lag of first or second order, a lag with an integrator; the least BIC decides. The
    interval is at 95 %; parts of the record show whether the delay varies. --write is for two
    forces, the one that the sensor measured and the one that the law used: its age is the delay of
    sampling.

    Example: nrs-design identify delay run.csv --command force_raw --measured force_used
    """
    from nrs_design.identification.datasets import read_signals
    from nrs_design.identification.delay import identify_delay
    from nrs_design.identification.write_spec import merge_delay
    from nrs_design.spec import read_spec

    if (command is None) != (measured is None):
        raise typer.BadParameter("name both columns or none", param_hint="--command, --measured")
    if write is not None and command is None:
        raise typer.BadParameter(
            "name the force as measured by --command, and as the law used it by --measured",
            param_hint="--write",
        )
    check_report(report)
    loaded = read_spec(write) if write is not None else None
    entries = list(columns or [])
    if command is not None:
        entries += [f"{INPUT}={command}", f"{OUTPUT}={measured}"]
    (record,) = read_all([log], read_signals, entries, quiet=quiet)
    with progress("fitting", quiet=quiet) as step:
        found = identify_delay(record)
        merged = merge_delay(loaded, found) if loaded else None
        if report is not None:
            from nrs_design.reporting.delay import delay_report

            step("figures")
            write_report(report, delay_report(found), date)
    if write is not None and merged is not None:
        write_spec(write, merged, quiet=quiet)
        # A proof will rest on this delay: no option silences this.
        for doubt in found.caveats:
            note(f"warning: {doubt}")
    if as_json:
        print_json("identify-delay", _summary(found))
    elif not quiet:
        _print(found)
    if report is not None:
        note(f"page written to {report}", quiet=quiet)


def _print(found: DelayIdentification) -> None:
    record = found.record
    if record.source.synthetic:
        say(SYNTHETIC)
    lag, correlation = found.peak
    sent, seen = record.names
    say(f"{seen} is most like {sent} {lag:.4g} s later (correlation {correlation:.3f})")
    least = min(fit.bic for fit in found.fits)
    rows = [
        [fit.follower.name, f"{fit.delay / record.step:.4g}", f"{fit.bic - least:.4g}"]
        for fit in found.fits
    ]
    print_table("", ["beside", "delay in samples", "BIC - least"], rows)
    say(f"delay = {interval(found.samples)} samples of {record.step:.4g} s [95 %]")
    say(f"delay = {interval(found.delay)} s, beside {found.chosen.follower.name}")
    low, high = found.whole_samples
    say(f"whole samples that hold it, and every part of the record: {low} to {high}")
    for doubt in found.doubts:
        say(f"doubt: {doubt}")


def _summary(found: DelayIdentification) -> dict[str, Any]:
    record = found.record
    return {
        "synthetic": record.source.synthetic,
        "records": sources([record.source]),
        "columns": {"command": record.names[0], "measured": record.names[1]},
        "sampling_step_s": record.step,
        "correlation_peak": {"lag_s": found.peak[0], "correlation": found.peak[1]},
        "chosen": found.chosen.follower.name,
        "delay_s": numbers(found.delay),
        "delay_samples": numbers(found.samples),
        "parts": [{"time_s": time, "samples": numbers(part)} for time, part in found.parts],
        "whole_samples": list(found.whole_samples),
        "fits": [
            {
                "beside": fit.follower.name,
                "delay_s": fit.delay,
                "bic": fit.bic,
                "whiteness_p": fit.uncertainty.whiteness,
            }
            for fit in found.fits
        ],
        "doubts": list(found.doubts),
    }
