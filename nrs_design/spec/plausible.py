"""Reasons to doubt a valid spec, such as sizes that no robot has: warnings, not errors.

Sizes that no surgical or co-worker robot has are one table, `sizes.toml`, for all quantities. What
lies outside is valid and probably a slip of the unit, which the same table names: the same number
in another unit that would lie within. The ranges are wide, so that what is doubted here is out of
the question by an order of magnitude or more.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from nrs_design.spec.check import find_faults
from nrs_design.spec.model import SpecModel
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.quantity_fields import Bounds, GainSpec, RangedQuantity
from nrs_design.spec.units import parse_unit

_Asked = tuple[tuple[str, ...], str]  # Keys that lead to a field, and the question
_TABLE = Path(__file__).with_name("sizes.toml")


@dataclass(frozen=True, slots=True)
class Size:
    """Plausible sizes of a quantity."""

    unit: str  # SI unit of the range, which tells the quantity
    # low, high: least and largest size; zero is never doubted, and signs do not count.
    low: float
    high: float
    # Units in which the same number may have been meant, the likeliest first.
    slips: tuple[str, ...] = ()
    # Keys of a spec that it is about; empty for all others in this unit.
    fields: frozenset[str] = frozenset()

    def holds(self, value: float) -> bool:
        """Tell whether a value in SI is plausible."""
        return value == 0 or self.low <= abs(value) <= self.high

    def doubt(self, value: float, number: str, unit: str) -> str | None:
        """Return the question about an implausible value in SI; None for a plausible one."""
        if self.holds(value):
            return None
        written = float(parse_unit(unit).factor) * math.pi ** parse_unit(unit).pi_power
        meant = []
        for slip in self.slips:
            other = parse_unit(slip)
            if self.holds(value / written * float(other.factor) * math.pi**other.pi_power):
                meant.append(f"{number} {slip}")
        if meant:
            return f"is that its unit? did you mean {' or '.join(meant[:2])}?"
        return f"is that its unit? {self.low:g} {self.unit} to {self.high:g} {self.unit} is usual"


@lru_cache(maxsize=1)
def sizes() -> tuple[Size, ...]:
    """Return the table: of the rows in one unit, those that name a field go before the others."""
    rows = tomllib.loads(_TABLE.read_text(encoding="utf-8"))["rows"]
    return tuple(
        Size(unit, low, high, tuple(slips.split()), frozenset(fields.split()))
        for unit, low, high, slips, fields in rows
    )


@lru_cache(maxsize=1024)
def size_of(field: str, dimension: tuple[int, ...]) -> Size | None:
    """Return the row of the table for a field of a spec; None for a quantity that it lacks.

    Of a bound or an end of a range, the field is the key above.
    """
    rows = [size for size in sizes() if parse_unit(size.unit).dimension == dimension]
    named = (size for size in rows if field in size.fields)
    return next(named, next((size for size in rows if not size.fields), None))


def doubt_size(field: str, value: float, unit: str, number: str | None = None) -> str | None:
    """Return the question about an implausible identified size in SI; None if it is plausible.

    `field` is the key that it has, or would have, in a spec.
    """
    size = size_of(field, parse_unit(unit).dimension)
    return None if size is None else size.doubt(value, number or f"{value:.4g}", unit)


def doubt_sizes(spec: SpecModel) -> Iterator[_Asked]:
    """Yield fields of a spec with implausible sizes, as keys that lead there, and a question.

    A field is asked about once, by its first size that is not plausible. Where a part of the spec
    has `accept_doubt`, and no doubts of an identification that this is about, nothing is asked.
    """
    yield from _once(_walk(spec, (), ""))


def unusual(part: SpecModel) -> tuple[str, ...]:
    """Return the questions about a part of a spec, accepted or not."""
    return tuple(text for _, text in _once(_parts(part, (), "")))


def _walk(value: object, at: tuple[str, ...], field: str) -> Iterator[_Asked]:
    if isinstance(value, Quantity):
        size = size_of(field, value.dimension)
        asked = size and size.doubt(value.si, value.text.split(" ")[0], value.unit)
        if asked:
            yield at, f"{'.'.join(at)} is {value.text}: {asked}"
    elif isinstance(value, SpecModel):
        reason, doubts = (getattr(value, key, None) for key in ("accept_doubt", "doubts"))
        if reason is None or doubts:
            yield from _parts(value, at, field)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield from _walk(item, (*at, str(key)), str(key))
    elif isinstance(value, tuple):
        for item in value:
            yield from _walk(item, at, field)


def _parts(model: SpecModel, at: tuple[str, ...], field: str) -> Iterator[_Asked]:
    # Ends of a range belong to the quantity of the parent key.
    ends = isinstance(model, RangedQuantity | GainSpec | Bounds)
    for key in type(model).model_fields:
        value = getattr(model, key)
        yield from _walk(value, at if ends else (*at, key), field if ends else key)


def _once(found: Iterator[_Asked]) -> Iterator[_Asked]:
    first: dict[tuple[str, ...], str] = {}
    for at, text in found:
        first.setdefault(at, text)
    return iter(first.items())


@dataclass(frozen=True, slots=True)
class Doubt:
    """Something that is allowed, and probably not meant."""

    at: tuple[str, ...]  # Keys that lead to it in the spec
    message: str  # The doubt in one line
    # A value of the design over its limit: how useless it makes the design; 0 where it has none.
    beyond: float = 0.0

    def __str__(self) -> str:
        """Return the message."""
        return self.message


def doubt_spec(spec: SpecModel) -> Iterator[Doubt]:
    """Yield what is doubtful about a spec, before anything is designed."""
    yield from (Doubt(at, text) for at, text in doubt_sizes(spec))
    for found in find_faults(spec.warnings, spec):
        yield Doubt(found["at"], f"{found['message']} ({found['remedy']})")


def worst_first(doubts: Iterable[Doubt]) -> tuple[Doubt, ...]:
    """Return doubts sorted by their distance beyond a limit, others in their order."""
    return tuple(sorted(doubts, key=lambda doubt: -doubt.beyond))
