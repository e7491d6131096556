"""Names from users as text that a page or a figure can show."""

from __future__ import annotations

import textwrap
from functools import cache

from nrs_design.printable import escaped, visible


def drawable(text: str) -> str:
    """Return `visible` text with escapes for what the font of figures has no letter."""
    shown = visible(text)
    if shown.isascii():
        return shown
    letters = _letters()
    return "".join(c if ord(c) in letters else escaped(c) for c in shown)


def wrapped_label(text: str, width: int) -> str:
    """Return drawable text in full, on as many lines as it needs."""
    lines: list[str] = []
    # Names of modes are made of parts between slashes, which are the places to break at.
    for part in drawable(text).replace("/", "/\0").split("\0"):
        for piece in textwrap.wrap(part, width, drop_whitespace=False) or [""]:
            if lines and len(lines[-1]) + len(piece) <= width:
                lines[-1] += piece
            else:
                lines.append(piece)
    return "\n".join(line.strip() for line in lines)


@cache
def _letters() -> frozenset[int]:
    from nrs_design.plotting import FT2Font, findfont

    return frozenset(FT2Font(findfont("DejaVu Sans")).get_charmap())
