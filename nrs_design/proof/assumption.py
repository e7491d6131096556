"""What a statement takes for granted, as data: no check reads a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self


@dataclass(frozen=True, slots=True)
class Assumption:
    """One thing that is taken for granted; the catalogue of certificates has it in words."""

    id: str  # Of its sentence, such as ``tissue.linear``
    # What the sentence is about: names, numbers with units, and keys of words, by field.
    said: tuple[tuple[str, tuple[str, ...]], ...] = ()

    @classmethod
    def of(cls, id: str, /, **said: object) -> Self:
        """Return an assumption; a tuple is a list of things, and what is empty is left out."""
        fields = (
            (name, tuple(map(str, value)) if isinstance(value, tuple) else (str(value),))
            for name, value in said.items()
            if value is not None and value is not False and value not in ("", ())
        )
        return cls(id, tuple(fields))
