"""``nrs-design identify delay``: how late a signal of a running loop comes."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.options import Date, ReportTo
from nrs_design.cli.printing import progress, say
from nrs_design.identification.cli.identify.common import (
    ColumnMap,
    WriteTo,
    deliver,
    print_fits,
    read_all,
)
from nrs_design.identification.facts.delay import delay_facts

if TYPE_CHECKING:
    from nrs_design.identification.delay.identify import DelayIdentification

INPUT, OUTPUT = "input_any", "output_any"


class Into(StrEnum):
    """Where a delay is written to."""

    DELAY = "delay"
    LATENCY = "latency"


@command("identify-delay")
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
    into: Annotated[
        Into, typer.Option(help="What --write puts down: delay of the force, or latency.")
    ] = Into.DELAY,
    write: WriteTo = None,
    report: ReportTo = None,
    date: Date = None,
) -> Answer:
    """Find how late a measured signal follows a command, in seconds and in samples.

    Cross-correlation first, then a fit of the delay beside what it must not be mistaken for: a
    copy, a lag of first or second order, a lag with an integrator; the simplest decides that no
    other beats by 10 in BIC. The interval is at 95 %; parts of the record show whether the delay
    varies. --write is for two forces, the one that the sensor measured and the one that the law
    used: its age is the delay of sampling. With --into latency it is for two commands, as the law
    computed it and as the drive took it: the time between is the latency of sampling.

    Example: nrs-design identify delay run.csv --command force_raw --measured force_used
    """
    from nrs_design.identification.datasets.records import read_signals
    from nrs_design.identification.delay.identify import identify_delay
    from nrs_design.identification.reporting.delay import delay_report
    from nrs_design.identification.write_spec import (
        check_delay_place,
        check_latency_place,
        merge_delay,
        merge_latency,
    )

    late = into is Into.LATENCY
    if (command is None) != (measured is None):
        raise typer.BadParameter("name both columns or none", param_hint="--command, --measured")
    if command is not None and command == measured:
        raise typer.BadParameter("name two columns", param_hint="--command, --measured")
    if write is not None and command is None:
        raise typer.BadParameter(
            "name the command as computed by --command, and as the drive took it by --measured"
            if late
            else "name the force as measured by --command, and as the law used it by --measured",
            param_hint="--write",
        )
    outputs = Destinations.checked(write, report, date)
    if outputs.spec is not None:
        (check_latency_place if late else check_delay_place)(outputs.spec)
    entries = list(columns or [])
    if command is not None:
        entries += [f"{INPUT}={command}", f"{OUTPUT}={measured}"]
    (record,) = read_all([log], read_signals, entries)
    with progress("fitting"):
        found = identify_delay(record)
    return deliver(
        outputs, found, delay_facts, _print, delay_report, merge_latency if late else merge_delay
    )


def _print(found: DelayIdentification) -> None:
    from nrs_design.identification.reporting.delay import delays
    from nrs_design.identification.statistics import span

    (lag, correlation), (sent, seen) = found.peak, found.record.names
    when = f"{abs(lag):.4g} s {'later' if lag >= 0 else 'earlier'}"
    say(f"{seen} is most like {sent} {when} (correlation {correlation:.3f})")
    print_fits(delays(found))
    say(f"delay = {found.samples} samples of {found.record.step:.4g} s [95 %]")
    say(f"delay = {found.delay} s, beside {found.chosen.follower.name}")
    whole = span(*found.whole_samples)
    say(f"whole samples that hold it, and every part of the record: {whole}")
