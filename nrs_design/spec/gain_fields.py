"""Field types for gains: given, or to be chosen by the design."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from nrs_design.spec import kinds
from nrs_design.spec.model import ReadBefore, SpecModel
from nrs_design.spec.quantity import Quantity, QuantityKind
from nrs_design.spec.quantity_fields import (
    AnyQuantity,
    quantity_schema,
    read_entries,
    read_quantity,
)
from nrs_design.spec.range_checks import BOUND_CHECKS

_KEYS = {
    "min": "smallest value that the design may choose",
    "max": "largest value that the design may choose",
}


class GainSpec(SpecModel):
    """A gain: fixed, with ``min == max``, or to be designed within bounds."""

    min: AnyQuantity = Field(description=_KEYS["min"])
    max: AnyQuantity = Field(description=_KEYS["max"])

    checks = BOUND_CHECKS

    @property
    def fixed(self) -> bool:
        """Whether the design may choose only one value."""
        return self.min.rational_part == self.max.rational_part


def _gain(kind: QuantityKind, *, positive: bool = True, designed: bool = True) -> ReadBefore:
    def read(value: object) -> object:
        if isinstance(value, str | Quantity):
            return dict.fromkeys(_KEYS, reader(value))
        return read_entries(value, tuple(_KEYS), reader)

    def reader(value: object) -> Quantity:
        return read_quantity(value, kind, positive=positive)

    return ReadBefore(read, _schema(kind, designed=designed))


def _schema(kind: QuantityKind, *, designed: bool) -> dict[str, Any]:
    single = quantity_schema(kind)
    bounds = {
        "type": "object",
        "properties": {key: single | {"description": text} for key, text in _KEYS.items()},
        "required": [*_KEYS],
        "additionalProperties": False,
    }
    return {"anyOf": [single, bounds]} if designed else single


InertiaGain = Annotated[GainSpec, _gain(kinds.INERTIA, positive=False)]
DampingGain = Annotated[GainSpec, _gain(kinds.IMPEDANCE)]
SpringGain = Annotated[GainSpec, _gain(kinds.SPRING, designed=False)]
