"""The base of all spec models."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import CoreSchema, core_schema

from nrs_design.spec.check import Row, run_checks


class SpecModel(BaseModel):
    """Frozen, with no key beyond the declared ones."""

    # Validators are built on first use: a command pays only for the kind of spec that it reads.
    model_config = ConfigDict(
        extra="forbid", frozen=True, arbitrary_types_allowed=True, defer_build=True
    )

    # What must not be, whatever its fields are for themselves. Each row asks for the fields that it
    # is about only, so that faults between valid fields are told although others are not valid.
    checks: ClassVar[tuple[Row[Any], ...]] = ()
    # What is allowed, and probably not meant.
    warnings: ClassVar[tuple[Row[Any], ...]] = ()

    @model_validator(mode="after")
    def _run_checks(self) -> Self:
        run_checks(self.checks, self, self.warnings)
        return self


def required(description: str) -> Any:
    """Return a field that a spec must have."""
    return Field(description=description)


def optional(description: str, default: object = None) -> Any:
    """Return a field that a spec may leave out, and what it is then."""
    return Field(default=default, description=description)


class ReadBy:
    """Marks a field whose value is what a function makes of the text, or of the data.

    Errors of the function are those of the field. Pydantic's own marker would also form the schema
    of the type that comes out, for writing it, which takes longer than to validate a spec; nobody
    writes specs this way. `schema` is the JSON Schema of what may stand there.
    """

    def __init__(
        self, read: Callable[[object], object], schema: dict[str, Any] | None = None
    ) -> None:
        self.read, self.schema = read, schema

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Return the schema that calls the function."""
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, core: Any, handler: Any) -> dict[str, Any]:
        """Return the JSON Schema."""
        return handler(core) if self.schema is None else dict(self.schema)


class ReadBefore(ReadBy):
    """Marks a field that is a model, whose short form a function writes out first."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Return the schema that calls the function, and then validates the model."""
        return core_schema.no_info_before_validator_function(self.read, handler(source))


def pair_schema(item: Any) -> dict[str, Any]:
    """Return the JSON Schema of a list of two such items, or of one of each."""
    return {"type": "array", "items": item, "minItems": 2, "maxItems": 2}


def keys_schema(keys: Mapping[str, Any], *required: str) -> dict[str, Any]:
    """Return the JSON Schema of a mapping with these keys alone."""
    return {
        "type": "object",
        "properties": dict(keys),
        "required": [*required],
        "additionalProperties": False,
    }
