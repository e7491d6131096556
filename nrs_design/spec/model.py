"""The base of all spec models."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, partial, reduce
from typing import Any, ClassVar, Literal, NamedTuple, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from pydantic_core import CoreSchema, core_schema

from nrs_design.spec.check import Row, run_checks

# Which of two values of a field asks for more. Of ranges: wider, the one that holds the other, and
# of two single values neither; farther, the same, and of two single values the larger; holding, the
# same, and a single value holds no other. Of lists: whole, the one that has all of the other.
# neither: they make another robot, law or system. unknown: another value is weaker, as is whatever
# cannot be compared. beside: no proof is about it, not even if it is left out.
Stronger = Literal[
    "larger", "smaller", "wider", "farther", "holding", "whole", "neither", "unknown", "beside"
]
# Requirement of a missing key. nothing: no requirement. most: the strongest requirement, because
# a declared value is an assumption. other: a requirement that has no order with declared values.
Unsaid = Literal["nothing", "most", "other"]


class Declared(NamedTuple):
    """The order of the values of a field, or the default order of a model's fields."""

    # A tuple lists words from the weakest to the strongest; None stands for a missing key.
    stronger: Stronger | tuple[object, ...] | None = None
    unsaid: Unsaid | None = None

    def over(self, other: Declared) -> Declared:
        """Return this, and what another one says where it says nothing."""
        return Declared(self.stronger or other.stronger, self.unsaid or other.unsaid)


class SpecModel(BaseModel):
    """Frozen, with no key beyond the declared ones."""

    # Validators are built on first use: a command pays only for the kind of spec that it reads.
    model_config = ConfigDict(
        extra="forbid", frozen=True, arbitrary_types_allowed=True, defer_build=True
    )

    # Default order of the fields, from the first line of the class; a field may declare another.
    declared: ClassVar[Declared] = Declared()
    # Checks across the fields of the model.
    checks: ClassVar[tuple[Row[Any], ...]] = ()
    # What is allowed, and probably not meant.
    warnings: ClassVar[tuple[Row[Any], ...]] = ()

    def __init_subclass__(
        cls, *, stronger: Stronger | None = None, unsaid: Unsaid | None = None, **config: Any
    ) -> None:
        """Keep what a class declares of its fields."""
        super().__init_subclass__(**config)
        cls.declared = Declared(stronger, unsaid).over(cls.declared)

    @model_validator(mode="after")
    def _run_checks(self) -> Self:
        run_checks(self.checks, self)
        return self


def required(description: str, stronger: Stronger | None = None) -> Any:
    """Return a field that a spec must have."""
    return _declaring(Declared(stronger), Field(description=description))


def optional(
    description: str,
    default: object = None,
    *,
    stronger: Stronger | tuple[object, ...] | None = None,
    unsaid: Unsaid | None = None,
) -> Any:
    """Return an optional field with its default."""
    return _declaring(Declared(stronger, unsaid), Field(default=default, description=description))


def _declaring(declared: Declared, field: Any) -> Any:
    # Place where pydantic keeps the metadata of a type.
    field.metadata.append(declared)
    return field


# A limit below which something must stay.
at_most = partial(optional, stronger="smaller")


@cache
def declared_in(model: type[SpecModel]) -> dict[str, Declared]:
    """Return how values of each field compare, by its key in a file."""
    found: dict[str, Declared] = {}
    for name, field in model.model_fields.items():
        said = [mark for mark in field.metadata if isinstance(mark, Declared)]
        said += [model.declared, Declared("unknown", "nothing")]
        found[field.alias or name] = reduce(Declared.over, said)
    return found


class ParsedBy:
    """Marks a field whose value a function reads from the text or from the data.

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


class ExpandedBy(ParsedBy):
    """Marks a field that is a model, whose short form a function writes out first."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> CoreSchema:
        """Return the schema that calls the function, and then validates the model."""
        return core_schema.no_info_before_validator_function(self.read, handler(source))


def fields_schema(model: type[SpecModel]) -> dict[str, Any]:
    """Return the JSON Schema of the fields of a model that functions read, by their keys."""
    return {
        key: {**mark.schema, "description": field.description}
        for key, field in model.model_fields.items()
        for mark in field.metadata
        if isinstance(mark, ParsedBy) and mark.schema is not None
    }


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
