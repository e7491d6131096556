"""Output streams that keep accepting text after their reader has gone."""

from __future__ import annotations

import io
import os
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer


class _DetachedOutput(io.FileIO):
    """Discards output once the reader has gone, as after ``| head``.

    The command then ends with the exit code and the files that it would have had.
    """

    def write(self, data: ReadableBuffer, /) -> int:
        try:
            return super().write(data)
        except BrokenPipeError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), self.fileno())
            return super().write(data)


def lasting(stream: TextIO | None) -> TextIO:
    """Return a stream for stdout or stderr that accepts every text, whether it is read or not.

    Characters that the encoding lacks are written as escapes. None is closed: nothing is printed.
    """
    if stream is None:
        return Path(os.devnull).open("w")
    try:
        raw = _DetachedOutput(stream.fileno(), "w", closefd=False)
    except (OSError, ValueError):
        # In a test or a notebook it is not a stream of the system.
        return stream
    stream.flush()
    return io.TextIOWrapper(
        io.BufferedWriter(raw),
        encoding=stream.encoding,
        errors="backslashreplace",
        line_buffering=stream.isatty() or stream.fileno() == 2,
        write_through=getattr(stream, "write_through", False),
    )
