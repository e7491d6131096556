"""Printing: results on stdout, progress and notes on stderr.

Here text leaves the program, and nowhere else in the command line: names and messages may come
from files that strangers wrote, so every line and every cell is made `printable`.
"""

from __future__ import annotations

import os
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO

from nrs_design.printable import json_text, printable

_CODES = {"red": "1;31", "green": "1;32", "yellow": "1;33", "blue": "1;34", "cyan": "36"}
COLOURS = {"proved": "green", "refuted": "red", "rejected": "red", "inconclusive": "yellow"}


def print_json(command: str, content: dict[str, Any]) -> None:
    """Print the versioned envelope of a command."""
    envelope = {"schema": f"nrs-design/{command}/1", **content}
    print(json_text(envelope, allow_nan=False))


def say(line: str = "", *, verdict: str = "") -> None:
    """Print one line of the result; the verdict in it, in capitals, is coloured on a terminal."""
    text = wrapped(printable(line), sys.stdout)
    word = verdict.upper()
    print(text.replace(word, painted(word, COLOURS[verdict], sys.stdout), 1) if word else text)


def say_failure(line: str, status: str) -> None:
    """Print one line about what is not fulfilled; its status is coloured on a terminal."""
    text, colour = wrapped(printable(line), sys.stdout), COLOURS.get(status, "red")
    print(text.replace(f"{status}:", f"{painted(status, colour, sys.stdout)}:", 1))


def note(line: str, *, quiet: bool = False) -> None:
    """Print one line on stderr."""
    if not quiet:
        print(wrapped(printable(line), sys.stderr), file=sys.stderr)


def painted(text: str, colour: str, stream: TextIO) -> str:
    """Colour a text if the stream is a terminal, and its user has not asked for none (NO_COLOR).

    Parameters
    ----------
    text : str
        What is printed.
    colour : str
        Such as ``red``.
    stream : TextIO
        Where it is printed.
    """
    dull = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return text if dull or not stream.isatty() else f"\x1b[{_CODES[colour]}m{text}\x1b[0m"


def wrapped(line: str, stream: TextIO, hanging: int = 2) -> str:
    """Break a line between words, as wide as the terminal is; a pipe gets it whole.

    Parameters
    ----------
    line : str
        Text without line breaks.
    stream : TextIO
        Where it is printed.
    hanging : int
        Spaces before the second and every later line.
    """
    if not stream.isatty():
        return line
    indent = " " * (len(line) - len(line.lstrip(" ")))
    return textwrap.fill(
        line.strip(),
        shutil.get_terminal_size().columns,
        initial_indent=indent,
        subsequent_indent=indent + " " * hanging,
        break_long_words=False,
        break_on_hyphens=False,
    )


@contextmanager
def progress(
    title: str, *, quiet: bool = False, lines: bool = False
) -> Iterator[Callable[[str], None]]:
    """Show a spinner with the current step on stderr, on a terminal only.

    Parameters
    ----------
    title : str
        What is done.
    quiet : bool
        Whether to show nothing.
    lines : bool
        Whether to write a line for each step where there is no terminal: for what takes minutes.

    Yields
    ------
    callable
        Tell it the name of the step that begins.
    """
    if quiet or not sys.stderr.isatty():
        yield lambda step: note(f"{title}: {step}", quiet=quiet or not lines)
        return
    from rich.console import Console
    from rich.markup import escape

    with Console(stderr=True).status(title) as status:
        yield lambda step: status.update(f"{title}: {escape(printable(step))}")
