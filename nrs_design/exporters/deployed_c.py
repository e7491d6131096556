"""Whether deployed C holds what was exported: the macros of a header, or the code of a source."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from fractions import Fraction

from nrs_design.controllers.float32 import exact_decimal, to_float32
from nrs_design.errors import DesignError

Numbers = Mapping[str, int | Fraction]
# Comments, and the strings that could hide where one begins.
_TOKEN = re.compile(
    r"""/\*.*?(?:\*/|\Z)|//[^\n]*|"(?:\\.|[^"\\\n])*"?|'(?:\\.|[^'\\\n])*'?""", re.DOTALL
)
# Lines that go on or end otherwise, and other ways to write a # or a backslash.
_STRANGE = re.compile(r"\\\n|\?\?|%:|[\x00-\x08\x0b-\x1f\x7f]")
_DEFINE = re.compile(r"define\s+([A-Za-z_]\w*)(?:\s+(.*))?", re.ASCII)
_WORD = re.compile(r"\d[\w.]*(?:(?<=[pPeE])[+-]\w+)?|\w+|\S", re.ASCII)
_MODE = re.compile(r"(0|[1-9]\d{0,8})U", re.ASCII)
_HEX = re.compile(r"0[xX]([0-9a-fA-F]{1,16})(?:\.([0-9a-fA-F]{0,16}))?[pP]([+-]?\d{1,4})[fF]")
_DECIMAL = re.compile(
    r"(\d{1,60}\.\d{0,160}|\.\d{1,160}|\d{1,60}(?=[eE]))(?:[eE]([+-]?\d{1,3}))?[fF]", re.ASCII
)


def macro_differences(
    text: str, guard: str, wanted: Numbers, includes: tuple[str, ...] = ()
) -> Iterator[str]:
    """Yield in what the macros of a header differ.

    Parameters
    ----------
    text : str
        Of the header.
    guard : str
        The macro that keeps it from being read twice.
    wanted : mapping of str to int or Fraction
        What the macros are.
    includes : tuple of str
        Headers of other exports that it includes.
    """
    text = text.replace("\r\n", "\n")
    for name in includes:
        text = text.replace(f'#include "{name}"\n', "\n", 1)
    macros, faults = _macros(text, guard)
    yield from faults
    for name in macros.keys() - wanted.keys():
        yield f"{name} is not a number of this law"
    for name, number in wanted.items():
        if name not in macros:
            yield f"{name} is missing"
        elif (found := _number(macros[name])) != (number, False) or not _same_type(found, number):
            yield f"{name} is {macros[name][:80]}, and the certificate has {_text(number)}"


def code_differences(text: str, wanted: str) -> Iterator[str]:
    """Yield the first place in which C code differs from what was exported; comments do not count.

    Parameters
    ----------
    text, wanted : str
        What was deployed, and what is exported.
    """
    if _STRANGE.search(text.replace("\r\n", "\n")):
        yield "it has characters that no export has"
        return
    found, exported = _tokens(text), _tokens(wanted)
    for k, (one, other) in enumerate(zip([*found, ""], [*exported, ""], strict=False)):
        if one != other:
            before = " ".join(exported[max(k - 4, 0) : k]).strip()
            yield f"after `{before}` it has `{one[:80]}`, and the export has `{other[:80]}`"
            return


def _tokens(text: str) -> list[str]:
    """Return words and signs of C; a directive ends with its line."""
    code = _TOKEN.sub(lambda found: " " if found[0][0] == "/" else found[0], text)
    tokens: list[str] = []
    for line in code.splitlines():
        tokens += _WORD.findall(line)
        tokens += ["\n"] if line.lstrip().startswith("#") else []
    return tokens


def _macros(text: str, guard: str) -> tuple[Mapping[str, str], list[str]]:
    """Return the macros of a header, and what else in it could change a number."""
    faults: list[str] = []
    if _STRANGE.search(text) or any(t[0] in "\"'" for t in _TOKEN.findall(text)):
        faults.append("it has strings or characters that no export has")
    lines = [line.strip() for line in _TOKEN.sub(" ", text).splitlines()]
    directives = [line[1:].strip() for line in lines if line.startswith("#")]
    faults += [f"#{d[:80]} is not in an export" for d in directives if not _usual(d, guard)]
    if [d.split()[0] for d in directives if _conditional(d)] != ["ifndef", "endif"]:
        faults.append("a part of it may not be compiled")
    found: dict[str, str] = {}
    for match in filter(None, map(_DEFINE.fullmatch, directives)):
        if match[1] in found:
            faults.append(f"{match[1]} is defined twice")
        found[match[1]] = (match[2] or "").strip()
    if found.pop(guard, None) != "":
        faults.append(f"the guard {guard} is missing")
    return found, faults


def _conditional(directive: str) -> bool:
    return bool(re.match(r"(if|el|endif)", directive))


def _usual(directive: str, guard: str) -> bool:
    includes = ("include <stdbool.h>", "include <stdint.h>")
    frame = (f"ifndef {guard}", "endif", *includes)
    return directive in frame or _DEFINE.fullmatch(directive) is not None


def _number(text: str) -> tuple[int | Fraction, bool] | None:
    """Return what a compiler takes a literal for, and whether as -0; None if it is unknown."""
    if match := _MODE.fullmatch(text):
        return int(match[1]), False
    inner = text[1:-1].strip() if text.startswith("(") and text.endswith(")") else text
    negative, digits = inner.startswith("-"), inner.removeprefix("-").strip()
    if match := _HEX.fullmatch(digits):
        after = match[2] or ""
        size = Fraction(int(match[1] + after, 16)) * Fraction(2) ** (int(match[3]) - 4 * len(after))
    elif match := _DECIMAL.fullmatch(digits):
        size = Fraction(match[1] + "0" * match[1].endswith(".")) * Fraction(10) ** int(
            match[2] or 0
        )
    else:
        return None
    try:
        held = to_float32(size)
    except DesignError:
        return None
    return (-held if negative else held), negative and not held


def _same_type(found: tuple[int | Fraction, bool] | None, number: int | Fraction) -> bool:
    """Tell whether both are integers or neither: 3000U is not 3000.0F in an expression."""
    return found is not None and isinstance(found[0], int) == isinstance(number, int)


def _text(number: int | Fraction) -> str:
    return f"{number}U" if isinstance(number, int) else exact_decimal(number)
