"""For every field of a spec, how a shipped spec writes it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from making.tables import Schema
from nrs_design.spec.document import parse_document, read_source, to_data

LONGEST = 48


class Example(NamedTuple):
    """A value as it is written, and where."""

    text: str
    link: str


def examples_of(
    specs: list[tuple[str, Path]], definitions: dict[str, Schema], roots: dict[str, str]
) -> dict[tuple[str, str], Example]:
    """Return the first short value of each key, by the names of definition and key.

    `specs` are links with their files, `definitions` schemas by name, `roots` the kind of spec of a
    definition.
    """
    found: dict[tuple[str, str], Example] = {}
    for link, path in specs:
        said: Any = to_data(parse_document(read_source(path)))
        root = next(name for name, kind in roots.items() if kind == said["kind"])
        for name, key, value in _walk(said, {"$ref": root}, "", definitions):
            text = _written(value)
            if text and len(text) <= LONGEST:
                found.setdefault((name, key), Example(text, link))
    return found


def _walk(
    said: Any, schema: Schema, name: str, definitions: dict[str, Schema]
) -> Iterator[tuple[str, str, Any]]:
    """Yield definition, key and value, for every key of a document."""
    if "$ref" in schema:
        name = schema["$ref"].rpartition("/")[2]
        yield from _walk(said, definitions[name], name, definitions)
        return
    for key in ("anyOf", "oneOf", "allOf"):
        for arm in schema.get(key, []):
            if _fits(said, arm, definitions):
                yield from _walk(said, arm, name, definitions)
    if isinstance(said, (list, tuple)):
        for item in said:
            yield from _walk(item, _items(schema), name, definitions)
    if isinstance(said, dict):
        named = schema.get("properties", {})
        held = [*schema.get("patternProperties", {}).values(), schema.get("additionalProperties")]
        others = held[0] if isinstance(held[0], dict) else {}
        for key, value in said.items():
            if key in named and name:
                yield name, key, value
            # The keys of a mapping without a name of its own belong to no table.
            yield from _walk(value, named.get(key, others), "", definitions)


def _items(schema: Schema) -> Schema:
    items = schema.get("items", {})
    return items if isinstance(items, dict) else {}


def _fits(said: Any, schema: Schema, definitions: dict[str, Schema]) -> bool:
    """Tell whether a value can be meant by an alternative: by its keys, and by what they select."""
    if "$ref" in schema:
        return _fits(said, definitions[schema["$ref"].rpartition("/")[2]], definitions)
    if not isinstance(said, dict):
        return schema.get("type") != "object"
    named = schema.get("properties")
    if named is None:
        return True
    return said.keys() <= named.keys() and all(
        said[key] == field["const"]
        for key, field in named.items()
        if "const" in field and key in said
    )


def _written(value: Any) -> str:
    """Write a value in the flow style of YAML."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_written(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_written, value)) + "]"
    return str(value)
