"""Text that others wrote, as text that can be shown: on a terminal, in a log, in a table."""

from __future__ import annotations

import json
import re
from typing import Any

# Letters and marks that are drawn as nothing; all other invisible characters are not printable.
_INVISIBLE = (
    "\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef"
)
# Start or part of a line that GitHub logs interpret as a command.
_COMMAND = re.compile(r"\A\s*:(?=:)|#(?=#\[)")
# First surrogate for a byte that is no text (PEP 383).
_FIRST_BYTE = 0xDC80
_STRANGE = re.compile(f"[{_INVISIBLE}]")


def printable(text: object) -> str:
    r"""Write a text on one line, with escapes for all that could deceive or steer the reader.

    Line breaks, control characters, terminal escapes, marks that change the direction of writing,
    invisible characters and lone surrogates are written as Python does in a string (``\x1b``);
    what a build server takes for a command is broken up. All else stays as it is.
    """
    return _COMMAND.sub(lambda found: found[0][:-1] + _hex(found[0][-1]), _escape(str(text)))


def visible(text: str) -> str:
    r"""Write a text for a page or a figure, where line breaks are spaces and no server listens.

    What has no shape of its own appears as an escape, such as ``\u202e``.
    """
    return _escape(" ".join(text.splitlines()) if "\n" in text or "\r" in text else text)


def escaped(character: str) -> str:
    r"""Write a character as Python does in a string, such as ``\x1b``.

    A byte of a file name that is no UTF-8 is written as that byte, as a shell takes it.
    """
    if _FIRST_BYTE <= ord(character) < _FIRST_BYTE + 0x80:
        return _hex(chr(ord(character) - _FIRST_BYTE + 0x80))
    return character.encode("unicode_escape").decode()


def _escape(text: str) -> str:
    if not text.isprintable():
        text = "".join(c if c.isprintable() else escaped(c) for c in text)
    if not text.isascii():
        text = _STRANGE.sub(lambda found: escaped(found[0]), text)
    return text


def json_text(document: object, **options: Any) -> str:
    """Write a JSON document so that its text is safe to show, too: ASCII, no control character."""
    text = json.dumps(document, indent=2, ensure_ascii=True, **options)
    return text.replace("\x7f", "\\u007f").replace("##[", "#\\u0023[")


def _hex(character: str) -> str:
    return f"\\x{ord(character):02x}"
