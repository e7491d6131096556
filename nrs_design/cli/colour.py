"""Colour, on a terminal only."""

from __future__ import annotations

import os
from typing import TextIO

_CODES = {"red": "1;31", "green": "1;32", "yellow": "1;33", "blue": "1;34", "cyan": "36"}
OF_VERDICT = {"proved": "green", "refuted": "red", "rejected": "red", "inconclusive": "yellow"}


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
