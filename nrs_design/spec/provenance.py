"""Sources and doubts of an identified value."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from nrs_design.spec.check import Row
from nrs_design.spec.edits import NOT_IDENTIFIED
from nrs_design.spec.fields import Hash, Title
from nrs_design.spec.model import SpecModel, optional, required
from nrs_design.spec.plausible import unusual
from nrs_design.spec.quantity import Quantity
from nrs_design.spec.quantity_fields import RangedQuantity

MAX_SOURCES = 1000
MAX_DOUBTS = 100

Coverage = Literal["confidence", "tolerance", "prediction"]
COVERS: Mapping[Coverage, str] = {
    "confidence": "the mean of the specimens with 95 % confidence, and each measured record",
    "tolerance": "95 % of all such specimens with 95 % confidence",
    "prediction": "the next record with 95 % probability",
}
# Sources of a motor, whose records are all fitted at once.
MOTOR_COVERS: Mapping[Coverage, str] = {
    **COVERS,
    "confidence": "gain and time constant of the recorded motor, both at once with 95 % confidence",
    "tolerance": "95 % of all records of such motors with 95 % confidence",
}


class ProvenanceSpec(SpecModel, stronger="beside"):
    """A file of measured data, as `nrs-design identify --write` notes it down."""

    file: Title = required("name of the data file, one line, no unit")
    sha256: Hash = required("SHA-256 of its bytes, 64 hexadecimal digits")
    data: Literal["measured", "synthetic"] = required("measured, or synthetic (by a simulation)")


Provenance = Annotated[tuple[ProvenanceSpec, ...], Field(max_length=MAX_SOURCES)]


class IdentifiedSpec(SpecModel):
    """Notes that `nrs-design identify --write` adds to the values."""

    provenance: Provenance = optional(
        "data files that the values were identified from", (), stronger="neither"
    )
    doubts: Annotated[tuple[Title, ...], Field(max_length=MAX_DOUBTS)] = optional(
        "why the records may not determine the values; the gate fails on them (NRS107)",
        (),
        stronger="whole",
    )
    accept_doubt: Title | None = optional(
        "why the values are used despite doubts or unusual sizes: one line, printed with every "
        "proof",
        stronger="neither",
        unsaid="most",
    )

    checks: ClassVar[tuple[Row[Any], ...]] = (
        Row(
            "accept_doubt",
            lambda s: s.accept_doubt is not None and not s.doubts and not unusual(s),
            "there are no doubts to accept",
            "remove accept_doubt",
        ),
        Row(
            "accept_doubt",
            lambda s: s.accept_doubt is not None and not s.accept_doubt.strip(),
            "no reason is given",
            "say in one line why",
        ),
    )


class IdentifiedRangesSpec(IdentifiedSpec):
    """What it notes down beside values with ranges: what they hold, and that they are those."""

    range_covers: Coverage | None = None
    range_id: Hash | None = optional(
        "SHA-256 over identified values and doubts; values changed since are refused",
        stronger="neither",
    )

    @property
    def ranges(self) -> dict[str, RangedQuantity]:
        """Its numbers that may have ranges, as written, by their keys."""
        return {name: value for name, value in self if isinstance(value, RangedQuantity)}

    checks: ClassVar[tuple[Row[Any], ...]] = (
        *IdentifiedSpec.checks,
        Row(
            "range_id",
            lambda s: s.range_id not in (None, s.values_id()),
            "the values are not those that range_covers and range_id are about: they were changed "
            "since they were identified",
            "identify them again, or remove range_covers and range_id",
        ),
    )

    def values_id(self) -> str:
        """Return the SHA-256 of the identified values, independent of the layout of the text."""
        names = [name for name in type(self).model_fields if name not in NOT_IDENTIFIED]
        canonical = json.dumps({name: _plain(getattr(self, name)) for name in names})
        return hashlib.sha256(canonical.encode()).hexdigest()


def _plain(value: object) -> Any:
    """Return a value of a spec as texts, a quantity exactly and in SI."""
    if isinstance(value, Quantity):
        return [str(value.rational_part), value.pi_power, list(value.dimension)]
    if isinstance(value, SpecModel):
        return {name: _plain(getattr(value, name)) for name in type(value).model_fields}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return None if value is None else str(value)
