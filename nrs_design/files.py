"""Regular files, in contrast to pipes and devices, on this system or another."""

from __future__ import annotations

import errno
import os
import re
import stat
from io import BufferedReader
from pathlib import Path
from typing import Any

# More values than any honest file holds; each takes some 100 bytes when it is parsed.
MAX_JSON_VALUES = 1_000_000

# Windows takes a file of one of these names, with any ending, for a device.
DEVICES = frozenset(
    ["con", "prn", "aux", "nul", *(f"{port}{k}" for port in ("com", "lpt") for k in range(10))]
)
# First bytes of HTML and PDF pages.
_PAGE = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:<!doctype html|<html\b|%PDF-)", re.IGNORECASE)


def is_page(content: bytes) -> bool:
    """Tell whether a file is a page of HTML or PDF, by how it begins."""
    return _PAGE.match(content) is not None


def is_device_name(name: str) -> bool:
    """Tell whether a file of this name, with or without an ending, is a device on Windows."""
    return name.partition(".")[0].strip(" ").lower() in DEVICES


def open_regular(path: Path) -> BufferedReader:
    """Open a regular file to read it; never wait for a pipe, nor read from a device.

    Any other is an `OSError`.
    """
    handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise OSError(errno.EINVAL, "it is not a regular file", str(path))
    return os.fdopen(handle, "rb")


def read_json_text(content: bytes) -> str:
    """Decode the text of a JSON file, and refuse what would take far more memory than its length.

    More than a million values, or no UTF-8, are a `ValueError`.
    """
    if sum(map(content.count, (b",", b"[", b"{"))) > MAX_JSON_VALUES:
        raise ValueError(f"it holds more than {MAX_JSON_VALUES} values")
    return content.decode("utf-8")


def unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """Make an object of JSON of its pairs; refuse one that another of its name would hide."""
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key occurs twice")
    return found
