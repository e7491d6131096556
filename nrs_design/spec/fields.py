"""Field types for numbers and text: how each reads its text, and its JSON Schema."""

from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction
from functools import partial
from typing import Annotated, Any

from nrs_design.files import is_device_name
from nrs_design.proof.text import quoted
from nrs_design.spec.exact import DECIMAL_PATTERN, RATIO_PATTERN, parse_exact
from nrs_design.spec.faults import as_text, fault, reported
from nrs_design.spec.model import ParsedBy

NAME_PATTERN = "^[a-z0-9][a-z0-9._-]{0,63}$"
LABEL_PATTERN = "^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$"
HASH_PATTERN = "^[0-9a-f]{64}$"
MAX_TITLE = 200
# One environment that is touched, or several at once.
Contact = str | tuple[str, ...]

NUMBER_SCHEMA: dict[str, Any] = {
    "anyOf": [
        {"type": "number"},
        {"type": "string", "pattern": f"^(?:{DECIMAL_PATTERN}|{RATIO_PATTERN})$"},
    ]
}
_LABEL: dict[str, Any] = {
    "anyOf": [{"type": "string", "pattern": LABEL_PATTERN}, {"type": "integer", "minimum": 0}]
}


def read_exact(value: object) -> Fraction:
    """Read an exact number; integers and fractions pass, floats and truth values do not."""
    if isinstance(value, Fraction):
        return value
    if isinstance(value, int) and not isinstance(value, bool):
        return Fraction(value)
    text = as_text(value)
    return reported(lambda: parse_exact(text))


def _number(accepts: Callable[[Fraction], bool], expected: str) -> ParsedBy:
    def read(value: object) -> Fraction:
        number = read_exact(value)
        if not accepts(number):
            raise fault(f"{value} is not {expected}", f"write a number that is {expected}")
        return number

    return ParsedBy(read, NUMBER_SCHEMA)


def whole(low: int, high: int) -> ParsedBy:
    """Return the marker of a field for a whole number within bounds."""

    def read(value: object) -> int:
        number = read_exact(value)
        if number.denominator != 1 or not low <= number <= high:
            expected = f"an integer from {low} to {high}"
            raise fault(f"{value} is not {expected}", f"write {expected}")
        return int(number)

    return ParsedBy(read, {"type": "integer", "minimum": low, "maximum": high})


def _read_name(value: object, pattern: str) -> str:
    text = as_text(value)
    if not re.fullmatch(pattern, text):
        raise fault(
            f"{quoted(text)} is not a name",
            "use 1 to 64 letters from a to z, digits, '.', '_' and '-'"
            f"{'' if 'A-Z' in pattern else ', no capitals'}, as in {pattern}",
        )
    if is_device_name(text):
        raise fault(
            f"{quoted(text)} names a device on Windows, and files are named by it",
            "choose another name",
        )
    return text


_read_label = partial(_read_name, pattern=LABEL_PATTERN)


def read_title(value: object) -> str:
    """Read one line of printable text."""
    text = as_text(value)
    if len(text) > MAX_TITLE:
        raise fault(f"the title has {len(text)} characters", f"keep it within {MAX_TITLE}")
    if not text.isprintable():
        raise fault("the title is not one line of printable text", "remove line breaks and escapes")
    return text


def read_hash(value: object) -> str:
    """Read a SHA-256 in hexadecimal."""
    text = as_text(value)
    if not re.fullmatch(HASH_PATTERN, text):
        raise fault(f"{quoted(text)} is not a SHA-256", "write 64 hexadecimal digits, lower case")
    return text


Exact = Annotated[Fraction, ParsedBy(read_exact, NUMBER_SCHEMA)]
UnitFraction = Annotated[Fraction, _number(lambda x: 0 < x < 1, "between 0 and 1")]
Weight = Annotated[Fraction, _number(lambda x: x >= 0, "zero or positive")]
Positive = Annotated[Fraction, _number(lambda x: x > 0, "positive")]
AboveOne = Annotated[Fraction, _number(lambda x: x > 1, "above 1")]
BelowTwo = Annotated[Fraction, _number(lambda x: 0 < x < 2, "between 0 and 2")]
# Significant digits: a float32 holds no more.
Digits = Annotated[int, whole(1, 7)]
_NAME = {"type": "string", "pattern": NAME_PATTERN}
Name = Annotated[str, ParsedBy(partial(_read_name, pattern=NAME_PATTERN), _NAME)]
Label = Annotated[str, ParsedBy(_read_label, _LABEL)]


def read_contact(value: object) -> Contact:
    """Read the name of an environment, or the names of all that are touched at the same time."""
    if not isinstance(value, list | tuple):
        return _read_label(value)
    names = tuple(map(_read_label, value))
    if len(names) < 2:
        raise fault(
            "a list within contacts is what is touched at once, two things at least",
            "write the name without a list of its own",
        )
    for index, name in enumerate(names):
        if name in names[:index]:
            raise fault(f"{name!r} is touched at once with itself", "list each environment once")
    return names


TouchedAtOnce = Annotated[
    Contact,
    ParsedBy(
        read_contact,
        {"anyOf": [*_LABEL["anyOf"], {"type": "array", "items": _LABEL, "minItems": 2}]},
    ),
]
Title = Annotated[str, ParsedBy(read_title, {"type": "string", "maxLength": MAX_TITLE})]
Hash = Annotated[str, ParsedBy(read_hash, {"type": "string", "pattern": HASH_PATTERN})]
