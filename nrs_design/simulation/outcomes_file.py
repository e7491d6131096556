"""A file that keeps what every run came to, line by line, so that an interrupted study goes on."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any, BinaryIO

from nrs_design.errors import DataError, OutputError
from nrs_design.files import open_regular
from nrs_design.simulation.monte_carlo import Outcome
from nrs_design.simulation.peaks import PEAKS

SCHEMA = "nrs-design/monte-carlo/1"
_BEGINNING = b'{"schema": "nrs-design/monte-carlo/'
_ELSE = "name another file, or go on with what it was begun with"
_NAMES = {
    "spec": "spec, by its name",
    "spec_sha256": "content of the spec, by its SHA-256",
    "commands_sha256": "recorded commands, by their SHA-256",
    "runs": "number of runs",
}
# A run is a few hundred letters.
_LONGEST = 2**20
MOST_RUNS = 1_000_000


def read_outcomes(path: Path, head: Mapping[str, Any]) -> list[Outcome]:
    """Return the runs that a file holds; none if it does not exist.

    A last line that is not whole is what an interrupt has left: it does not count.

    Parameters
    ----------
    path : Path
        The file.
    head : mapping
        What all runs are of: its first line must say the same.

    Raises
    ------
    DataError
        If it is of another study or spec, no file of ours, or cannot be read.
    """
    if not os.path.lexists(path):
        return []
    try:
        with open_regular(path) as stream:
            return _read(stream, path, head)
    except OSError as error:
        message = f"cannot be read ({error.strerror})"
        raise DataError(message, path=path, remedy="name another file") from error
    except (ValueError, TypeError, AttributeError, RecursionError) as error:
        message = f"keeps no runs of a study that can be read ({error})"
        raise DataError(message, path=path, remedy=_ELSE) from None


def _read(stream: BinaryIO, path: Path, head: Mapping[str, Any]) -> list[Outcome]:
    """Read line by line, and not one more than the study has runs: so long is a file of ours."""
    if stream.read(len(_BEGINNING)) != _BEGINNING:
        raise DataError("keeps no runs of a study", path=path, remedy="name another file")
    stream.seek(0)
    lines = _whole_lines(stream)
    line = next(lines, None)
    if line is None:
        message = "is cut off within its first line, so it keeps no runs"
        raise DataError(message, path=path, remedy="delete it, or name another file")
    first = json.loads(line)
    if not isinstance(first, dict) or not _header(head).keys() <= first.keys():
        raise ValueError("its first line does not say of what they are")
    for key, value in _header(head).items():
        if first.get(key) != value:
            message = f"was begun with {_difference(key, first.get(key), value)}"
            raise DataError(message, path=path, remedy=_ELSE)
    outcomes: list[Outcome] = []
    for line in lines:
        one = Outcome(**json.loads(line))
        known = one.peaks.keys() == PEAKS.keys() and isinstance(one.uncovered, list)
        if not known or one.index != len(outcomes) or one.index >= head.get("runs", MOST_RUNS):
            raise DataError("does not keep the runs of a study in order", path=path, remedy=_ELSE)
        outcomes.append(one)
    return outcomes


def _whole_lines(stream: BinaryIO) -> Iterator[bytes]:
    while line := stream.readline(_LONGEST + 1):
        if len(line) > _LONGEST:
            raise ValueError(f"a line is longer than {_LONGEST} bytes")
        if line.endswith(b"\n"):
            yield line


def _difference(key: str, was: object, now: object) -> str:
    """Say how a study differs from the one that is asked for, in the words of the command."""
    if not isinstance(was, dict) or not isinstance(now, dict):
        return f"other {_NAMES.get(key, key)}: {was!s:.80}, not {now!s:.80}"
    odd = (name for name in now if was.get(name) != now[name])
    each = (f"{_option(name, was.get(name))}, not {_option(name, now[name])}" for name in odd)
    return "; ".join(each) or f"other {key}"


def _option(name: str, value: object) -> str:
    """Return an option as it is typed."""
    option = "--scenario" if name == "names" else f"--{name.replace('_', '-')}"
    if value is None or value == []:
        return f"no {option}"
    return f"{option} {' '.join(map(str, value)) if isinstance(value, list) else value}"[:80]


@contextmanager
def appending(path: Path, head: Mapping[str, Any]) -> Iterator[_Appender]:
    """Open a file to add runs, each whole or not at all; it is made if it does not exist.

    Parameters
    ----------
    path : Path
        As `read_outcomes` has found it.
    head : mapping
        For the first line.

    Raises
    ------
    OutputError
        If it cannot be written.
    """
    flags = os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_NOFOLLOW", 0)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path, flags, 0o666)
    except OSError as error:
        raise OutputError(f"cannot be written ({error.strerror})", path=path) from error
    try:
        appender = _Appender(descriptor)
        whole = appender.drop_torn_line()
        if not whole:
            appender.line(_header(head))
        yield appender
    finally:
        os.close(descriptor)


class _Appender:
    """Writes lines to the end of a file."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def drop_torn_line(self) -> int:
        """Cut off a last line without an end; return how long the file is then."""
        size = os.fstat(self._descriptor).st_size
        kept = size
        while kept:
            start = max(0, kept - 65536)
            os.lseek(self._descriptor, start, os.SEEK_SET)
            end = os.read(self._descriptor, kept - start).rfind(b"\n")
            if end >= 0:
                kept = start + end + 1
                break
            kept = start
        if kept < size:
            os.ftruncate(self._descriptor, kept)
        return kept

    def add(self, outcome: Outcome) -> None:
        """Add a run."""
        self.line(asdict(outcome))

    def line(self, content: Mapping[str, Any]) -> None:
        """Write a line at once."""
        os.write(self._descriptor, (json.dumps(content, ensure_ascii=True) + "\n").encode())


def _header(head: Mapping[str, Any]) -> dict[str, Any]:
    return {"schema": SCHEMA, **head}
