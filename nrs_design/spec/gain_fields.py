"""Field types for gains: given, or to be chosen by the design."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from nrs_design.spec import kinds
from nrs_design.spec.faults import fault
from nrs_design.spec.model import ReadBefore, SpecModel, optional
from nrs_design.spec.quantity import Quantity, QuantityKind
from nrs_design.spec.quantity_fields import (
    AnyQuantity,
    quantity_schema,
    read_entries,
    read_quantity,
)
from nrs_design.spec.range_checks import BOUND_CHECKS

_KEYS = {
    "nominal": "the gain; not with min and max",
    "min": "smallest value that the design may choose",
    "max": "largest value that the design may choose",
}


class GainSpec(SpecModel):
    """A gain: fixed, with ``min == max``, or to be designed within bounds."""

    nominal: AnyQuantity | None = optional(_KEYS["nominal"])
    min: AnyQuantity = Field(
        default_factory=lambda data: data.get("nominal"), description=_KEYS["min"]
    )
    max: AnyQuantity = Field(
        default_factory=lambda data: data.get("nominal"), description=_KEYS["max"]
    )

    checks = BOUND_CHECKS

    @property
    def fixed(self) -> bool:
        """Whether the design may choose only one value."""
        return self.min.rational_part == self.max.rational_part


def _gain(kind: QuantityKind, *, positive: bool = True, designed: bool = True) -> ReadBefore:
    def read(value: object) -> object:
        if isinstance(value, str | Quantity):
            return {"nominal": read_quantity(value, kind, positive=positive)}
        entries = read_entries(value, tuple(_KEYS), reader)
        if isinstance(entries, dict):
            _check_keys(entries)
        return entries

    def reader(value: object) -> Quantity:
        return read_quantity(value, kind, positive=positive)

    return ReadBefore(read, _schema(kind, designed=designed))


def _check_keys(entries: dict[str, object]) -> None:
    """Say what is missing or too much; unknown keys are left to the model."""
    if not entries.keys() <= _KEYS.keys():
        return
    if "nominal" in entries:
        for key in ("min", "max"):
            if key in entries:
                raise fault(
                    f"nominal and {key} exclude each other",
                    "write nominal for a gain that is given, min and max for one to be designed",
                    key,
                )
        return
    for key in ("min", "max"):
        if key not in entries:
            raise fault(
                f"`{key}` is missing",
                f"add {key}: {_KEYS[key]}; or write nominal for a gain that is given",
            )


def _schema(kind: QuantityKind, *, designed: bool) -> dict[str, Any]:
    single = quantity_schema(kind)
    known = {key: single | {"description": text} for key, text in _KEYS.items()}

    def mapping(*required: str) -> dict[str, Any]:
        return {
            "type": "object",
            "properties": {key: known[key] for key in required},
            "required": list(required),
            "additionalProperties": False,
        }

    chosen = [mapping("min", "max")] if designed else []
    return {"anyOf": [single, *chosen, mapping("nominal")]}


InertiaGain = Annotated[GainSpec, _gain(kinds.INERTIA, positive=False)]
DampingGain = Annotated[GainSpec, _gain(kinds.IMPEDANCE)]
SpringGain = Annotated[GainSpec, _gain(kinds.SPRING, designed=False)]
