"""Checks of numbers in ranges, and parameters of switched systems."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Annotated, Any

from pydantic import Field

from nrs_design.proof.text import quoted
from nrs_design.spec.check import Row
from nrs_design.spec.exact import parse_exact
from nrs_design.spec.expression import EXPRESSION_PATTERN, Affine, parse_affine
from nrs_design.spec.faults import as_text, fault, reported
from nrs_design.spec.fields import NUMBER_SCHEMA, read_exact
from nrs_design.spec.model import ParsedBy, SpecModel, optional, pair_schema, required
from nrs_design.spec.quantity import Quantity, is_less

Number = Quantity | Fraction


def _is_below(a: Any, b: Any) -> bool:
    return is_less(a, b) if isinstance(a, Quantity) else a < b


def _text(number: Number) -> str:
    return number.text if isinstance(number, Quantity) else str(number)


def _shown(number: Number) -> str:
    return quoted(number.text) if isinstance(number, Quantity) else str(number)


def is_within(number: Number, ends: tuple[Number, Number]) -> bool:
    """Tell whether a number lies in a closed range."""
    return not (_is_below(number, ends[0]) or _is_below(ends[1], number))


def _mixed(said: Any) -> bool:
    """Return whether nominal value and range have different units."""
    numbers = (said.nominal, *said.range)
    return len({q.dimension for q in numbers if isinstance(q, Quantity)}) > 1


def _reversed(said: Any) -> tuple[str, str] | None:
    """Return the ends of a range that is written the wrong way round."""
    if said.range is None or not _is_below(said.range[1], said.range[0]):
        return None
    return _shown(said.range[1]), _shown(said.range[0])


def _outside(said: Any) -> tuple[str, ...] | None:
    """Return a nominal value that is not within its range, and the ends."""
    if _mixed(said) or _reversed(said) or is_within(said.nominal, said.range):
        return None
    return _shown(said.nominal), *map(_text, said.range)


def _crossed(said: Any) -> tuple[str, str] | None:
    """Return largest and smallest value, if the first is below the second."""
    return (_shown(said.max), _shown(said.min)) if _is_below(said.max, said.min) else None


ORDERED_RANGE = Row[Any](
    "range",
    lambda s: not (s.range and getattr(s, "nominal", None) and _mixed(s)) and _reversed(s),
    "the range ends at {0}, below its start {1}",
    "write [lowest, highest]",
)


def range_around(description: str) -> Any:
    """Return the field of a range around the nominal value, which is that alone by default."""
    return Field(default_factory=lambda data: (data.get("nominal"),) * 2, description=description)


# Checks of a nominal value and a range around it.
RANGE_CHECKS: tuple[Row[Any], ...] = (
    Row("range", _mixed, "nominal and range have different units", "use one unit"),
    ORDERED_RANGE,
    Row(
        "nominal",
        _outside,
        "nominal {0} is outside the range [{1}, {2}]",
        "widen the range or correct the nominal value",
    ),
)
# Checks of a smallest and a largest value.
BOUND_CHECKS: tuple[Row[Any], ...] = (
    Row("max", _crossed, "max {0} is below min {1}", "swap them"),
)


PARAMETER_PATTERN = "^[A-Za-z][A-Za-z0-9_]{0,31}$"
MAX_PARAMETERS = 16
# Beyond this a number is a slip of the pen, and products of such numbers leave the floats.
LARGEST = Fraction(10) ** 30

# Texts that are read as attempts at a number.
_RESERVED = frozenset(["nan", "inf", "infinity", "true", "false", "yes", "no", "on", "off", "null"])


def read_parameter_name(value: object) -> str:
    """Read the name of a parameter."""
    text = as_text(value)
    if not re.fullmatch(PARAMETER_PATTERN, text):
        raise fault(
            f"{quoted(text)} is not a name of a parameter",
            "use a letter, then up to 31 letters, digits and '_'",
        )
    if text.lower() in _RESERVED:
        raise fault(f"{quoted(text)} is a reserved word", "choose another name")
    return text


def read_entry(value: object) -> Affine:
    """Read a matrix entry: an exact number, or an expression that is affine in the parameters."""
    if isinstance(value, str):
        return reported(lambda: parse_affine(value))
    return Affine(read_exact(value))


def _read_switch(value: object) -> bool:
    if isinstance(value, bool):
        return value
    text = as_text(value)
    if text not in ("true", "false"):
        raise fault(f"{quoted(text)} is not known", "write true or false")
    return text == "true"


def _read_value(value: object, *at: int | str) -> Fraction:
    if not isinstance(value, int | Fraction):
        text = as_text(value, *at)
        value = reported(lambda: parse_exact(text), *at)
    number = read_exact(value)
    if abs(number) > LARGEST:
        raise fault(f"{number} is beyond +-1e30", "choose another unit or scale", *at)
    return number


def _read_range(value: object) -> tuple[Fraction, Fraction]:
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise fault("expected two numbers", "write [lowest, highest]")
    return _read_value(value[0], 0), _read_value(value[1], 1)


_Value = Annotated[Fraction, ParsedBy(_read_value, NUMBER_SCHEMA)]
_Range = Annotated[tuple[Fraction, Fraction], ParsedBy(_read_range, pair_schema(NUMBER_SCHEMA))]
ParameterName = Annotated[
    str, ParsedBy(read_parameter_name, {"type": "string", "pattern": PARAMETER_PATTERN})
]
Switch = Annotated[bool, ParsedBy(_read_switch, {"type": "boolean"})]
Entry = Annotated[
    Affine,
    ParsedBy(
        read_entry,
        {"anyOf": [*NUMBER_SCHEMA["anyOf"], {"type": "string", "pattern": EXPRESSION_PATTERN}]},
    ),
]


class ParameterSpec(SpecModel):
    """An uncertain number that the matrices depend on."""

    nominal: _Value = required("value that is meant, an exact number, no unit")
    range: _Range = range_around("[lowest, highest] value that is proved; default: the nominal one")
    varies: Switch = optional("true: changes arbitrarily fast; false: an unknown constant", True)

    @property
    def fixed(self) -> bool:
        """Whether the range is a single value."""
        return self.range[0] == self.range[1]

    checks = RANGE_CHECKS
