"""Names that others chose, as text that a page or a figure can show."""

from __future__ import annotations

import textwrap
from functools import cache


def visible(text: str) -> str:
    r"""Write what has no shape of its own as an escape, such as ``\u202e``; line breaks as spaces.

    Control characters, marks that change the direction of writing and lone surrogates would
    make a reader see something else than what is there.
    """
    joined = " ".join(text.splitlines()) if "\n" in text or "\r" in text else text
    if joined.isprintable():
        return joined
    return "".join(c if c.isprintable() else _escape(c) for c in joined)


def drawable(text: str) -> str:
    """Return `visible` text with escapes for what the font of figures and PDF has no letter."""
    shown = visible(text)
    if shown.isascii():
        return shown
    letters = _letters()
    return "".join(c if ord(c) in letters else _escape(c) for c in shown)


def wrapped(text: str, width: int) -> str:
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


def _escape(character: str) -> str:
    return character.encode("unicode_escape").decode()


@cache
def _letters() -> frozenset[int]:
    from nrs_design.plotting import load_matplotlib

    load_matplotlib()
    from matplotlib.font_manager import findfont
    from matplotlib.ft2font import FT2Font

    return frozenset(FT2Font(findfont("DejaVu Sans")).get_charmap())
