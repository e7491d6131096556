"""Output that lasts as long as the command, even if its reader does not."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class _Unheard(io.FileIO):
    """Writes into the void once the reader has gone, as ``head`` does when it has its lines.

    A command then ends as it would have: what it decides and writes does not depend on who reads.
    """

    def write(self, data: ReadableBuffer, /) -> int:
        try:
            return super().write(data)
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
            return super().write(data)


def lasting(stream: TextIO | None) -> TextIO:
    """Return a stream in place of stdout or stderr that takes every text, heard or not.

    Characters that its encoding does not have are written as escapes.

    Parameters
    ----------
    stream : TextIO or None
        None if the caller has closed it: then nothing is printed.
    """
    if stream is None:
        return Path(os.devnull).open("w")
    try:
        raw = _Unheard(stream.fileno(), "w", closefd=False)
    except (OSError, ValueError):
        # Within a test or a notebook: no stream of the system's.
        return stream
    stream.flush()
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding=stream.encoding,
        errors="backslashreplace",
        line_buffering=stream.isatty() or stream.fileno() == 2,
        write_through=getattr(stream, "write_through", False),
    )
