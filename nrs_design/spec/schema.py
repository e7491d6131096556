"""JSON Schema of spec files, for editors and other tools."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from nrs_design.printable import json_text
from nrs_design.spec.load import SPEC_KINDS, model_of

DIALECT = "http://json-schema.org/draft-07/schema#"
# Facts for Python alone: class names, null for an absent key, defaults that are objects.
_INTERNAL = ("title", "default", "discriminator")


def schema_text() -> str:
    """Return the JSON Schema as the text of a file."""
    return json_text(json_schema()) + "\n"


def json_schema() -> dict[str, Any]:
    """Describe all kinds of specs as one JSON Schema, draft-07: ``kind`` selects the model.

    Quantities are strings with a pattern; exact numbers are numbers or strings. Every key has a
    description that names its unit.
    """
    definitions: dict[str, Any] = {}
    choices = []
    for kind in SPEC_KINDS:
        model = model_of(kind)
        definitions |= _definitions(model)
        choices.append(_choice(kind, model))
    return {
        "$schema": DIALECT,
        "title": "nrs-design spec",
        "description": "An interaction design, a switched system or a sampled one, *.nrs.yaml",
        "type": "object",
        "required": ["kind"],
        "properties": {
            "kind": {"enum": list(SPEC_KINDS), "description": "what this file describes"}
        },
        "allOf": choices,
        "definitions": dict(sorted(definitions.items())),
    }


def _choice(kind: str, model: type[BaseModel]) -> dict[str, Any]:
    return {
        "if": {"properties": {"kind": {"const": kind}}, "required": ["kind"]},
        "then": {"$ref": f"#/definitions/{model.__name__}"},
    }


def _definitions(model: type[BaseModel]) -> dict[str, Any]:
    schema = model.model_json_schema(ref_template="#/definitions/{model}")
    nested = schema.pop("$defs", {})
    found = {name: _plain(definition) for name, definition in nested.items()}
    found[model.__name__] = _plain(schema)
    return found


def _plain(schema: Any, *, names: bool = False) -> Any:
    """Reduce a generated schema to draft-07; below ``properties`` the keys are names."""
    if isinstance(schema, list):
        return [_plain(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {
        key: _plain(value, names=key == "properties")
        for key, value in schema.items()
        if names or key not in _INTERNAL
    }
    return kept if names else _described_reference(_closed(_required_value(kept)))


def _closed(schema: dict[str, Any]) -> dict[str, Any]:
    """Refuse keys that are no names where a pattern says what a name is."""
    return schema | {"additionalProperties": False} if "patternProperties" in schema else schema


def _required_value(schema: dict[str, Any]) -> dict[str, Any]:
    """Drop the alternative ``null``: an optional key is left out, never null."""
    arms = schema.get("anyOf")
    if not arms or {"type": "null"} not in arms:
        return schema
    arms = [arm for arm in arms if arm != {"type": "null"}]
    rest = {key: value for key, value in schema.items() if key != "anyOf"}
    return arms[0] | rest if len(arms) == 1 else rest | {"anyOf": arms}


def _described_reference(schema: dict[str, Any]) -> dict[str, Any]:
    """Wrap a reference with a description: draft-07 ignores the siblings of ``$ref``."""
    if "$ref" not in schema or len(schema) == 1:
        return schema
    rest = {key: value for key, value in schema.items() if key != "$ref"}
    return rest | {"allOf": [{"$ref": schema["$ref"]}]}
