"""What all identifications share: options, reading with a progress bar, and writing."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from nrs_design.cli.printing import is_quiet
from nrs_design.printable import printable

if TYPE_CHECKING:
    from nrs_design.identification.datasets import Source
    from nrs_design.identification.statistics import Estimate

DataFiles = Annotated[list[Path], typer.Argument(metavar="DATA...", help="Files of data.")]
ColumnMap = Annotated[
    list[str] | None,
    typer.Option("--map", metavar="OURS=THEIRS", help="Foreign column name, as in force_N=Fz."),
]
WriteTo = Annotated[
    Path | None,
    typer.Option("--write", metavar="SPEC", help="Merge the result into this spec file."),
]


class CoversOption(StrEnum):
    """What the range in a spec holds."""

    CONFIDENCE = "confidence"
    TOLERANCE = "tolerance"
    PREDICTION = "prediction"


SYNTHETIC = "SYNTHETIC data: made by a simulation, not measured."

T = TypeVar("T")


def read_all(
    paths: Sequence[Path],
    read: Callable[[Path, dict[str, str], Callable[[float], None]], T],
    entries: Sequence[str],
) -> list[T]:
    """Read every file; large ones show how far they are.

    Parameters
    ----------
    paths : sequence of Path
        The files.
    read : callable
        Reads one of them; it takes the columns by name, and a function to tell progress to.
    entries : sequence of str
        ``name=column`` each, as the user gave them.
    """
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


def estimate_numbers(estimate: Estimate) -> dict[str, float | None]:
    """Return an estimate for JSON, which has no infinity; None says unlimited."""
    low, high = (end if math.isfinite(end) else None for end in (estimate.low, estimate.high))
    return {"value": estimate.value, "low": low, "high": high}


def sources(files: Iterable[Source]) -> list[dict[str, Any]]:
    """Return what identifies the data files, for JSON."""
    return [
        {"file": str(file.path), "sha256": file.sha256, "synthetic": file.synthetic}
        for file in files
    ]
