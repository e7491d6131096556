"""Checks of ranges and bounds, of quantities and of plain numbers alike: one table."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from pydantic import Field

from nrs_design.proof.text import quoted
from nrs_design.spec.check import Row
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


# Of a nominal value and a range around it.
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
# Of a smallest and a largest value.
BOUND_CHECKS: tuple[Row[Any], ...] = (
    Row("max", _crossed, "max {0} is below min {1}", "swap them"),
)
