"""File names, which may be hostile, as text that can be shown, linked to and parsed."""

from __future__ import annotations

import os
from pathlib import Path, PurePath
from urllib.parse import quote


def is_utf8(path: PurePath) -> bool:
    """Tell whether a file name is valid UTF-8, so that JSON and XML can hold it."""
    try:
        str(path).encode()
    except UnicodeEncodeError:
        return False
    return True


def from_here(path: Path) -> str:
    """Return a path relative to the working folder, with forward slashes.

    CI systems run a step in the root of the repository and resolve names from there.
    """
    relative = Path(os.path.relpath(path)).as_posix()
    return relative.encode(errors="surrogateescape").decode(errors="backslashreplace")


def relative_uri(path: Path) -> str:
    """Return a path relative to the working folder as a percent-encoded URI reference."""
    return quote(os.fsencode(Path(os.path.relpath(path)).as_posix()))
