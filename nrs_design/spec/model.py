"""The base of all spec models."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from enum import Enum, auto
from functools import cache, partial
from typing import Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import CoreSchema, core_schema

from nrs_design.spec.check import Row, run_checks


class Stronger(Enum):
    """Which of two values of a field asks for more; every field says so, or its model does."""

    LARGER = auto()
    SMALLER = auto()
    WIDER = auto()  # A range that holds the other one; of two single values, neither
    FARTHER = auto()  # The same; of two single values, the larger
    HOLDING = auto()  # The same; a single value holds no other
    WHOLE = auto()  # A list that has all that the other one has
    NEITHER = auto()  # They make another robot, law or system
    UNKNOWN = auto()  # Nobody knows, so another value is weaker
    BESIDE = auto()  # No proof is about it, not even if it is left out


class Unsaid(Enum):
    """What a field asks for that is left out."""

    NOTHING = auto()
    MOST = auto()  # What is said is assumed
    OTHER = auto()  # Something else, and nobody knows whether that is more


# Words stand in the order of what they ask for, least first; None where nothing is said.
Declared = tuple[Stronger | tuple[object, ...], Unsaid]


class SpecModel(BaseModel):
    """Frozen, with no key beyond the declared ones."""

    # Validators are built on first use: a command pays only for the kind of spec that it reads.
    model_config = ConfigDict(
        extra="forbid", frozen=True, arbitrary_types_allowed=True, defer_build=True
    )

    # Of the fields that do not say it themselves.
    stronger: ClassVar[Stronger]
    unsaid: ClassVar[Unsaid] = Unsaid.NOTHING

    def __init_subclass__(
        cls, *, stronger: Stronger | None = None, unsaid: Unsaid | None = None, **config: Any
    ) -> None:
        """Keep what a class says in its first line."""
        super().__init_subclass__(**config)
        if stronger is not None:
            cls.stronger = stronger
        if unsaid is not None:
            cls.unsaid = unsaid

    # What must not be, whatever its fields are for themselves. Each row asks for the fields that it
    # is about only, so that faults between valid fields are told although others are not valid.
    checks: ClassVar[tuple[Row[Any], ...]] = ()
    # What is allowed, and probably not meant.
    warnings: ClassVar[tuple[Row[Any], ...]] = ()

    @model_validator(mode="after")
    def _run_checks(self) -> Self:
        run_checks(self.checks, self, self.warnings)
        return self


def required(description: str, stronger: Stronger | None = None) -> Any:
    """Return a field that a spec must have."""
    return _marked(Field(description=description), stronger)


def optional(
    description: str,
    default: object = None,
    *,
    stronger: Stronger | tuple[object, ...] | None = None,
    unsaid: Unsaid | None = None,
) -> Any:
    """Return a field that a spec may leave out, and what it is then."""
    return _marked(Field(default=default, description=description), stronger, unsaid)


def _marked(field: Any, *declared: object) -> Any:
    """Return a field with what it declares beside its type, where pydantic keeps such things."""
    field.metadata += [mark for mark in declared if mark is not None]
    return field


# Of a limit below which something must stay.
at_most = partial(optional, stronger=Stronger.SMALLER)


@cache
def declared(model: type[SpecModel]) -> dict[str, Declared]:
    """Return how values of each field compare, by its key in a file."""
    found: dict[str, Declared] = {}
    for name, field in model.model_fields.items():
        marks = field.metadata
        stronger = next((m for m in marks if isinstance(m, Stronger | tuple)), None)
        unsaid = next((m for m in marks if isinstance(m, Unsaid)), model.unsaid)
        if stronger is None:
            stronger = getattr(model, "stronger", Stronger.UNKNOWN)
        found[field.alias or name] = stronger, unsaid
    return found


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
