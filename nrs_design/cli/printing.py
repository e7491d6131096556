"""Printing: results on stdout, progress and notes on stderr.

Here text leaves the program, and nowhere else in the command line: names and messages may come
from files that strangers wrote, so every line and every cell is made `printable`. What --json and
--quiet silence is decided here, too: `output` sets it for a command, and no command asks.
"""

from __future__ import annotations

import os
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from time import monotonic
from typing import Any, TextIO

from nrs_design.printable import json_text, printable

_CODES = {"red": "1;31", "green": "1;32", "yellow": "1;33", "blue": "1;34", "cyan": "36"}
# Seconds between two progress lines on a stream without a spinner.
SILENCE = 10.0
# Columns of a line where there is no terminal, and COLUMNS does not say otherwise.
WIDTH = 100
COLOURS = {"proved": "green", "refuted": "red", "rejected": "red", "inconclusive": "yellow"}

_json: ContextVar[bool] = ContextVar("json", default=False)
_quiet: ContextVar[bool] = ContextVar("quiet", default=False)
_verbose: ContextVar[bool] = ContextVar("verbose", default=False)


@contextmanager
def output(*, as_json: bool, quiet: bool, verbose: bool = False) -> Iterator[None]:
    """Set what is printed within: a JSON document, no text and no notes, or all of the text."""
    tokens = _json.set(as_json), _quiet.set(quiet), _verbose.set(verbose)
    try:
        yield
    finally:
        _json.reset(tokens[0])
        _quiet.reset(tokens[1])
        _verbose.reset(tokens[2])


def wants_json() -> bool:
    """Whether the result is wanted as JSON."""
    return _json.get()


def wants_text() -> bool:
    """Whether the result is wanted as text."""
    return not (_json.get() or _quiet.get())


def wants_details() -> bool:
    """Whether the result is wanted as text, and all of it."""
    return wants_text() and _verbose.get()


def is_quiet() -> bool:
    """Whether --quiet silences all but errors and the result."""
    return _quiet.get()


def print_json(command: str, content: dict[str, Any]) -> None:
    """Print the versioned envelope of a command."""
    envelope = {"schema": f"nrs-design/{command}/1", **content}
    print(json_text(envelope, allow_nan=False))


def say(line: str = "", *, verdict: str = "", hanging: int = 2) -> None:
    """Print one line of the result; the verdict in it, in capitals, is coloured on a terminal."""
    if not wants_text():
        return
    text = wrapped(printable(line), sys.stdout, hanging)
    word = verdict.upper()
    print(text.replace(word, painted(word, COLOURS[verdict], sys.stdout), 1) if word else text)


def detail(line: str) -> None:
    """Print one line of the result under --verbose."""
    if wants_details():
        say(line)


def say_failure(line: str, status: str) -> None:
    """Print one line about a missed obligation, also under --quiet, with a coloured status."""
    text, colour = wrapped(printable(line), sys.stdout), COLOURS.get(status, "red")
    print(text.replace(f"{status}:", f"{painted(status, colour, sys.stdout)}:", 1))


def note(line: str) -> None:
    """Print one line on stderr, unless --quiet silences it."""
    if not _quiet.get():
        insist(line)


def insist(line: str) -> None:
    """Print one line on stderr that no option silences."""
    print(wrapped(printable(line), sys.stderr), file=sys.stderr)


def painted(text: str, colour: str, stream: TextIO) -> str:
    """Colour a text if the stream is a terminal, unless the user has set NO_COLOR."""
    dull = os.environ.get("NO_COLOR") or os.environ.get("TERM") == "dumb"
    return text if dull or not stream.isatty() else f"\x1b[{_CODES[colour]}m{text}\x1b[0m"


def columns(stream: TextIO) -> int:
    """Return how wide a line may be: as the terminal is, or COLUMNS says; elsewhere `WIDTH`."""
    known = shutil.get_terminal_size((WIDTH, 24))
    return known.columns if stream.isatty() or "COLUMNS" in os.environ else WIDTH


def wrapped(line: str, stream: TextIO, hanging: int = 2) -> str:
    """Break a line between words, as wide as the terminal is."""
    indent = " " * (len(line) - len(line.lstrip(" ")))
    return textwrap.fill(
        line.strip(),
        columns(stream),
        initial_indent=indent,
        subsequent_indent=indent + " " * hanging,
        break_long_words=False,
        break_on_hyphens=False,
    )


@contextmanager
def progress(title: str, *, lines: bool = False) -> Iterator[Callable[[str], None]]:
    """Show the current step on stderr: a spinner on a terminal, elsewhere a line now and then.

    Under --quiet, show nothing. Tell what is yielded the name of the step that begins; `lines`:
    write a line for each step, too, where there is no terminal.
    """
    if _quiet.get():
        yield lambda step: None
        return
    if not sys.stderr.isatty():
        last_report = start = monotonic()

        def tell(step: str) -> None:
            nonlocal last_report
            now = monotonic()
            if lines or now - last_report > SILENCE:
                last_report = now
                note(f"{title}: {step} ({now - start:.0f} s)")

        yield tell
        return
    from rich.console import Console
    from rich.markup import escape

    with Console(stderr=True).status(title) as status:
        yield lambda step: status.update(f"{title}: {escape(printable(step))}")
