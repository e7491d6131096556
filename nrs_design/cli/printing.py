"""Printing: results on stdout, progress and notes on stderr.

Here text leaves the program, and nowhere else in the command line: names and messages may come
from files that strangers wrote, so every line and every cell is made `printable`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from nrs_design.printable import json_text, printable

# Output into a file or a pipe: wide enough that no table is folded.
WIDE = 160


def print_json(command: str, content: dict[str, Any]) -> None:
    """Print the versioned envelope of a command."""
    envelope = {"schema": f"nrs-design/{command}/1", **content}
    print(json_text(envelope, allow_nan=False))


def say(line: str = "") -> None:
    """Print one line of the result."""
    print(printable(line))


def print_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a plain table; a cell is never cut, only folded where the terminal is narrow."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    table = Table(title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
    table.title = printable(title) or None
    for column in columns:
        table.add_column(column, overflow="fold")
    for row in rows:
        table.add_row(*map(printable, row))
    width = None if sys.stdout.isatty() else WIDE
    Console(width=width, markup=False, emoji=False, highlight=False).print(table)


def note(line: str, *, quiet: bool = False) -> None:
    """Print one line on stderr."""
    if not quiet:
        print(printable(line), file=sys.stderr)


@contextmanager
def progress(title: str, *, quiet: bool = False) -> Iterator[Callable[[str], None]]:
    """Show a spinner with the current step on stderr, on a terminal only.

    Yields
    ------
    callable
        Tell it the name of the step that begins.
    """
    if quiet or not sys.stderr.isatty():
        yield lambda step: None
        return
    from rich.console import Console
    from rich.markup import escape

    with Console(stderr=True).status(title) as status:
        yield lambda step: status.update(f"{title}: {escape(printable(step))}")
