"""What all identifications share: options, reading with a progress bar, and writing."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeVar

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.printing import is_quiet, say, wants_details
from nrs_design.cli.tables import print_table
from nrs_design.identification.facts.finding import Facts, finding_facts
from nrs_design.identification.finding import Finding, is_synthetic
from nrs_design.printable import printable

if TYPE_CHECKING:
    from nrs_design.reporting import Report
    from nrs_design.reporting.document import Table
    from nrs_design.spec import LoadedSpec

DataFiles = Annotated[list[Path], typer.Argument(metavar="DATA...", help="Files of data.")]
ColumnMap = Annotated[
    list[str] | None,
    typer.Option("--map", metavar="OURS=THEIRS", help="Foreign column name, as in force_N=Fz."),
]
WriteTo = Annotated[
    Path | None,
    typer.Option("--write", metavar="SPEC", help="Merge the result into this spec file."),
]
Replace = Annotated[
    bool,
    typer.Option(
        "--replace",
        help="Let --write narrow a declared range by few records, or by much; a doubt remains.",
    ),
]


class CoversOption(StrEnum):
    """What the range in a spec holds."""

    CONFIDENCE = "confidence"
    TOLERANCE = "tolerance"
    PREDICTION = "prediction"


SYNTHETIC = "SYNTHETIC data: made by a simulation, not measured."

T = TypeVar("T")
F = TypeVar("F", bound=Finding)


def read_all(
    paths: Sequence[Path],
    read: Callable[[Path, dict[str, str], Callable[[float], None]], T],
    entries: Sequence[str],
) -> list[T]:
    """Read every file, with columns named as the user said; large ones show how far they are."""
    from nrs_design.identification.tables.columns import parse_mapping

    mapping = parse_mapping(entries)
    with _bar() as begin:
        return [read(path, mapping, begin(path.name)) for path in paths]


@contextmanager
def _bar() -> Iterator[Callable[[str], Callable[[float], None]]]:
    if is_quiet() or not sys.stderr.isatty():
        yield lambda name: lambda fraction: None
        return
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bars:

        def begin(name: str) -> Callable[[float], None]:
            task = bars.add_task(f"reading {escape(printable(name))}", total=1.0)
            return lambda fraction: bars.update(task, completed=fraction)

        yield begin


def print_fits(table: Table) -> None:
    """Print a table of the page, which its headings explain, where all is wanted."""
    if wants_details():
        print_table("", table.columns, table.rows)


def deliver(
    outputs: Destinations,
    found: F,
    facts: Callable[[F], Facts],
    show: Callable[[F], None],
    page: Callable[[F], Report],
    merge: Callable[[LoadedSpec, F], str],
) -> Answer:
    """Print and write what was found; where it is in doubt, the answer is inconclusive."""

    def show_all() -> None:
        if is_synthetic(found.sources):
            say(SYNTHETIC)
        show(found)
        for remark in found.remarks:
            say(remark)
        for doubt in found.doubts:
            say(f"doubt: {doubt}")

    code = exit_codes.INCONCLUSIVE if found.doubts else exit_codes.PROVED
    answer = Answer(lambda: finding_facts(found, facts(found)), show_all, code)
    return outputs.deliver(
        answer,
        lambda: page(found),
        lambda spec: merge(spec, found),
        found.doubts,
        found.caveats,
    )
