"""Exact numbers: the decimal text of a spec becomes a fraction, never a binary float."""

from __future__ import annotations

import re
import unicodedata
from fractions import Fraction

from nrs_design.errors import SpecError
from nrs_design.proof.text import quoted

MAX_LENGTH = 100
MAX_EXPONENT = 100

# A leading zero ("010") is octal in older YAML and ten in newer: it is refused.
_INTEGER = r"(?:0|[1-9][0-9]*)"
UNSIGNED_DECIMAL_PATTERN = rf"(?:{_INTEGER}(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
DECIMAL_PATTERN = rf"[+-]?{UNSIGNED_DECIMAL_PATTERN}"
RATIO_PATTERN = rf"[+-]?{_INTEGER}/[1-9][0-9]*"

_DECIMAL = re.compile(DECIMAL_PATTERN)
_RATIO = re.compile(RATIO_PATTERN)
_EXPECTED = 'write an integer, a decimal such as -0.25 or 1.5e-3, or a ratio such as "1/6"'
_DASHES = "\u2010\u2011\u2012\u2013\u2014\u2212\ufe63\uff0d"

# In this order: the first pattern that a refused text meets names its fault. None is compiled
# before a text is refused.
_FAULTS: tuple[tuple[str, str, str], ...] = (
    (r"\s*", "is empty", _EXPECTED),
    (r"(?s)\s.*|.*\s", "has spaces around it", "remove the spaces"),
    (rf".*[{_DASHES}].*", "has a typographic minus", "use the ASCII hyphen '-'"),
    (r"(?s).*[^\x00-\x7f].*", "has characters outside ASCII", _EXPECTED),
    (r"(?i)[+-]?\.?(?:nan|inf|infinity)", "is not a finite number", _EXPECTED),
    (r"(?i)true|false|yes|no|on|off", "is a truth value", _EXPECTED),
    (r"[+-]?[0-9]+/[+-]?0+", "divides by zero", "use a nonzero denominator"),
    (r"[+-]?[0-9]+/-[0-9]+", "has a signed denominator", "put the sign in front"),
    (r"(?i)[+-]?0[xob].*", "is not in base ten", _EXPECTED),
    (r"[+-]?[0-9][0-9._]*_.*", "has underscores", "write the digits without underscores"),
    (r"[+-]?0[0-9].*", "starts with a superfluous zero", "remove the leading zeros"),
    (r"[+-]?[0-9]+,[0-9]+.*", "has a comma", "use the decimal point '.'"),
)


def is_number(text: str) -> bool:
    """Whether the text is written as an integer, a decimal or a ratio; caps are not checked."""
    return bool(_RATIO.fullmatch(text) or _DECIMAL.fullmatch(text))


def parse_exact(text: str) -> Fraction:
    """Read an integer, a decimal or a ratio ``p/q`` exactly.

    At most 100 ASCII characters, and exponents between -100 and 100. A `SpecError` for anything
    else: ``nan``, ``true``, ``1/0``, a unicode minus, other digits than 0-9, underscores,
    hexadecimal or octal notation.
    """
    if len(text) > MAX_LENGTH:
        raise SpecError(
            f"the number {quoted(text)} has {len(text)} characters, at most {MAX_LENGTH} are read",
            remedy="write fewer digits",
        )
    if _RATIO.fullmatch(text):
        return Fraction(text)
    if _DECIMAL.fullmatch(text):
        _refuse_huge_exponent(text)
        return Fraction(text)
    raise number_fault(text) or SpecError(f"{quoted(text)} is not a number", remedy=_EXPECTED)


def _refuse_huge_exponent(text: str) -> None:
    """Stop before 10**exponent is formed: "1e3000000000" would never end."""
    _, _, exponent = text.lower().partition("e")
    if exponent and abs(int(exponent)) > MAX_EXPONENT:
        raise SpecError(
            f"the exponent of {quoted(text)} is beyond +-{MAX_EXPONENT}",
            remedy="choose a unit or a scale with a smaller exponent",
        )


def number_fault(text: str) -> SpecError | None:
    """Recognize a number that is written in a way that is not read, and say why; else None.

    Long texts are not looked at: some patterns take long for them.
    """
    if len(text) > 2 * MAX_LENGTH:
        return None
    for pattern, message, remedy in _FAULTS:
        if re.fullmatch(pattern, text):
            return SpecError(f"the number {quoted(text)} {message}{_named(text)}", remedy=remedy)
    return None


def _named(text: str) -> str:
    """Name the first character outside ASCII, which often looks like an ASCII one."""
    strange = next((c for c in text if ord(c) > 127), None)
    if strange is None:
        return ""
    return f" (U+{ord(strange):04X} {unicodedata.name(strange, 'unnamed')})"
