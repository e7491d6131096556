"""Printing: results on stdout, progress and notes on stderr."""

from __future__ import annotations

import json
import shutil
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TextIO


def print_json(command: str, content: dict[str, Any]) -> None:
    """Print the versioned envelope of a command."""
    envelope = {"schema": f"nrs-design/{command}/1", **content}
    print(json.dumps(envelope, indent=2, ensure_ascii=True, allow_nan=False))


def wrapped(text: str, stream: TextIO, hanging: int = 2) -> str:
    """Break the lines of a text between words, as wide as the terminal; a pipe gets them whole."""
    if not stream.isatty():
        return text
    return "\n".join(_wrapped_line(line, hanging) for line in text.split("\n"))


def _wrapped_line(line: str, hanging: int) -> str:
    indent = " " * (len(line) - len(line.lstrip(" ")))
    return textwrap.fill(
        line.strip(),
        shutil.get_terminal_size().columns,
        initial_indent=indent,
        subsequent_indent=indent + " " * hanging,
        break_long_words=False,
        break_on_hyphens=False,
    )


def say(text: str) -> None:
    """Print a sentence of the result."""
    print(wrapped(text, sys.stdout))


def note(text: str, *, quiet: bool = False) -> None:
    """Print a note on stderr."""
    if not quiet:
        print(wrapped(text, sys.stderr), file=sys.stderr)


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

    with Console(stderr=True).status(title) as status:
        yield lambda step: status.update(f"{title}: {step}")
