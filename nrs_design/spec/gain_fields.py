"""Field types for gains: how the design may choose them, and where the proof must cover them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from nrs_design.proof.text import quoted
from nrs_design.spec import kinds
from nrs_design.spec.check import Row
from nrs_design.spec.faults import fault
from nrs_design.spec.model import ReadBefore, SpecModel, optional
from nrs_design.spec.quantity import Quantity, QuantityKind, is_less
from nrs_design.spec.quantity_fields import (
    AnyQuantity,
    quantity_schema,
    read_entries,
    read_quantity,
    read_range,
)
from nrs_design.spec.range_checks import BOUND_CHECKS, ORDERED_RANGE, is_within

_KEYS = {
    "nominal": "the gain; not with min and max",
    "min": "smallest value that the design may choose",
    "max": "largest value that the design may choose",
}
_RANGE = (
    "[lowest, highest] value that the proof covers, however fast the gain changes in between while "
    "the robot runs; both positive; default: the designed value only"
)


class GainSpec(SpecModel):
    """A gain: fixed or to be designed within bounds, and perhaps retuned while the robot runs.

    A fixed gain has ``min == max``.
    """

    nominal: AnyQuantity | None = optional(_KEYS["nominal"])
    min: AnyQuantity = Field(
        default_factory=lambda data: data.get("nominal"), description=_KEYS["min"]
    )
    max: AnyQuantity = Field(
        default_factory=lambda data: data.get("nominal"), description=_KEYS["max"]
    )
    range: tuple[AnyQuantity, AnyQuantity] | None = optional(_RANGE)

    def _outside(self) -> str | None:
        """Return a given gain that is not within its range."""
        if self.range is None or not self.fixed or is_less(self.range[1], self.range[0]):
            return None
        return None if is_within(self.min, self.range) else quoted(self.min.text)

    def _apart(self) -> bool:
        """Return whether bounds and range have no value in common."""
        if self.range is None or self.fixed:
            return False
        return is_less(self.max, self.range[0]) or is_less(self.range[1], self.min)

    checks = (
        *BOUND_CHECKS,
        ORDERED_RANGE,
        Row(
            "range",
            _outside,
            "{0} is outside the range [{s.range[0].text}, {s.range[1].text}]",
            "widen the range or correct the gain",
        ),
        Row(
            "range",
            _apart,
            "the range [{s.range[0].text}, {s.range[1].text}] and the bounds [{s.min.text}, "
            "{s.max.text}] have no value in common",
            "min and max are for the design, the range is for the proof: let them overlap",
        ),
    )

    @property
    def fixed(self) -> bool:
        """Whether the design may choose only one value."""
        return self.min.rational_part == self.max.rational_part

    @property
    def ranged(self) -> bool:
        """Whether the proof must cover more than the designed value."""
        return self.range is not None and is_less(*self.range)


def _gain(kind: QuantityKind, *, positive: bool = True, designed: bool = True) -> ReadBefore:
    def read(value: object) -> object:
        if isinstance(value, str | Quantity):
            return {"nominal": read_quantity(value, kind, positive=positive)}
        entries = read_entries(value, tuple(_KEYS), reader)
        if isinstance(entries, dict):
            _check_keys(entries)
            if "range" in entries:
                entries["range"] = read_range(entries["range"], end)
        return entries

    def reader(value: object) -> Quantity:
        return read_quantity(value, kind, positive=positive)

    def end(value: object) -> Quantity:
        quantity = read_quantity(value, kind, positive=False)
        if quantity.value == 0:
            raise fault(
                f"a range cannot reach {quoted(quantity.text)}: {_AT_ZERO[kind.name]}",
                "give positive ends, or one value instead of a range",
            )
        return quantity

    return ReadBefore(read, _schema(kind, designed=designed))


# Why the ends of a range are positive, by the name of the kind.
_AT_ZERO = {
    kinds.INERTIA.name: "without inertia the loop has one state less, so no state is shared",
    kinds.IMPEDANCE.name: "without damping the admittance does not follow from the force",
    kinds.SPRING.name: "without a spring nothing draws the admittance back",
}


def _check_keys(entries: dict[str, object]) -> None:
    """Say what is missing or too much; unknown keys are left to the model."""
    if not entries.keys() <= {*_KEYS, "range"}:
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
    ends: dict[str, Any] = {"type": "array", "items": single, "minItems": 2, "maxItems": 2}
    known["range"] = ends | {"description": _RANGE}

    def mapping(*required: str) -> dict[str, Any]:
        return {
            "type": "object",
            "properties": {key: known[key] for key in (*required, "range")},
            "required": list(required),
            "additionalProperties": False,
        }

    chosen = [mapping("min", "max")] if designed else []
    return {"anyOf": [single, *chosen, mapping("nominal")]}


InertiaGain = Annotated[GainSpec, _gain(kinds.INERTIA, positive=False)]
DampingGain = Annotated[GainSpec, _gain(kinds.IMPEDANCE)]
SpringGain = Annotated[GainSpec, _gain(kinds.SPRING, designed=False)]
