"""The base of all spec models."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pydantic import BaseModel, ConfigDict
from pydantic_core import CoreSchema, core_schema


class SpecModel(BaseModel):
    """Frozen, with no key beyond the declared ones."""

    # Validators are built on first use: a command pays only for the kind of spec that it reads.
    model_config = ConfigDict(
        extra="forbid", frozen=True, arbitrary_types_allowed=True, defer_build=True
    )

    def across(self) -> tuple[Callable[[], object], ...]:
        """Return the checks between parts; none by default.

        Each asks for the parts that it is about when it is called, and reports a fault if they do
        not fit: so the faults between valid parts can be told although others are not valid.
        """
        return ()


class ReadBy:
    """Marks a field whose value is what a function makes of the text, or of the data.

    Pydantic's own marker would also form the schema of the type that comes out, for writing it,
    which takes longer than to validate a spec; nobody writes specs this way.

    Parameters
    ----------
    read : callable
        Takes the value as it stands in the file; its errors are those of the field.
    """

    def __init__(self, read: Callable[[object], object]) -> None:
        self.read = read

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Return the schema that calls the function."""
        return core_schema.no_info_plain_validator_function(self.read)
