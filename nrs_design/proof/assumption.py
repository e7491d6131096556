"""Assumptions of a statement, as data: no check reads a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self


@dataclass(frozen=True, slots=True)
class Assumption:
    """One assumption of a statement; `nrs_design.certificates.catalogue` renders its sentence."""

    id: str  # Id of its sentence, such as ``tissue.linear``
    # Values of the sentence by field: names, numbers with units, keys of words.
    fields: tuple[tuple[str, tuple[str, ...]], ...] = ()

    def __str__(self) -> str:
        """Return id and fields."""
        fields = "; ".join(f"{name}: {', '.join(values)}" for name, values in self.fields)
        return f"{self.id} ({fields})"

    @classmethod
    def create(cls, id: str, /, **values: object) -> Self:
        """Return an assumption; a tuple is a list of values, and empty values are left out."""
        fields = (
            (name, tuple(map(str, value)) if isinstance(value, tuple) else (str(value),))
            for name, value in values.items()
            if value is not None and value is not False and value not in ("", ())
        )
        return cls(id, tuple(fields))
