"""Whether a deployed text is what was exported: C token by token, other files line by line."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import zip_longest

# Comments, and the strings that could hide where one begins.
_TOKEN = re.compile(
    r"""/\*.*?(?:\*/|\Z)|//[^\n]*|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?""", re.DOTALL
)
# Lines that go on or end otherwise, and other ways to write a # or a backslash.
_STRANGE = re.compile(r"\\\n|\?\?|%:|[\x00-\x08\x0b-\x1f\x7f]")
# Numbers, names, operators of two signs (`& &x` is no `&& x`), and single signs.
_WORD = re.compile(
    r"\d[\w.]*(?:(?<=[pPeE])[+-]\w+)?|\w+|->|\+\+|--|&&|\|\||<<|>>|##|[-+*/%&|^<>=!]=|\S",
    re.ASCII,
)
_PARAMETERS = re.compile(r"\s*#\s*define\s+\w+\(", re.ASCII)
# The line that names the release which wrote a file.
_RELEASE = re.compile(r"^# nrs-design \d[\w.+]{0,40}(?=, nrs-design/export/1$)", re.MULTILINE)
_END = "\n"
# For a line that ends within a comment, and so does not end: it is white, and no text has it.
_BREAK = "\f"
_LONGEST = 80


def code_differences(text: str, wanted: str) -> Iterator[str]:
    """Yield the first place in which C code differs from what was exported; comments do not count.

    Parameters
    ----------
    text, wanted : str
        What was deployed, and what is exported: of a header or a source.
    """
    text = text.replace("\r\n", "\n")
    if _STRANGE.search(text):
        yield "it has characters that no export has"
        return
    before: list[str] = []
    for (line, one), (_, other) in zip_longest(_tokens(text), _tokens(wanted), fillvalue=(0, "")):
        if one != other:
            where = f"line {line}, after" if line else "at its end, after"
            yield f"{where} `{' '.join(before[-4:]).strip()}`: {_said(one, other)}"
            return
        before.append(other)


def line_differences(text: str, wanted: str) -> Iterator[str]:
    """Yield the first line that differs from what was exported; the release may differ.

    Comments count: to a reader of Python or CMake, some of them are none.

    Parameters
    ----------
    text, wanted : str
        What was deployed, and what is exported: a table, a test in Python, a file of CMake.
    """
    found, exported = (
        enumerate(_RELEASE.sub("", one, count=1).split("\n"), 1)
        for one in (text.replace("\r\n", "\n"), wanted)
    )
    for (number, one), (_, other) in zip_longest(found, exported, fillvalue=(0, "")):
        if one != other:
            where = f"line {number}" if number else "at its end"
            yield f"{where}: {_said(one, other)}"
            return


def _said(one: str, other: str) -> str:
    has, wanted = (_shown(text) for text in (one, other))
    return f"it has {has}, and the export has {wanted}"


def _shown(text: str) -> str:
    named = {"": "nothing", _END: "the end of a line", f"{_END}(": "a macro with parameters"}
    return named.get(text, f"`{text.strip()[:_LONGEST]}`")


def _tokens(text: str) -> Iterator[tuple[int, str]]:
    """Yield words and signs of C with their lines; a directive ends with its line."""
    code = _TOKEN.sub(lambda found: _blank(found[0]) if found[0][0] == "/" else found[0], text)
    number = 1
    for line in code.split("\n"):
        yield from ((number, word) for word in _WORD.findall(line))
        if line.lstrip().startswith("#"):
            # The one place where a space counts: with it, what follows is no list of parameters.
            yield number, f"{_END}(" if _PARAMETERS.match(line) else _END
        number += 1 + line.count(_BREAK)


def _blank(comment: str) -> str:
    """Return what stands for a comment: a space, as C has it, and how many lines it took."""
    return " " + _BREAK * comment.count("\n")
