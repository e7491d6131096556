"""JSON Schemas as tables in words."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

from making.faults import refuse

Schema = dict[str, Any]
Row = Callable[[str, Schema], tuple[str, ...]]


def cell(text: str) -> str:
    """Make a text fit into a cell of a table."""
    return text.replace("``", "`").replace("|", "\\|").replace("\n", " ")


def link(name: str) -> str:
    """Name a definition, with a link to its table."""
    return f"[{name.removesuffix('Spec')}](#{name.lower()})"


def type_of(field: Schema) -> str:
    """Name a type in words, with links to the fields of mappings."""
    if "$ref" in field:
        return link(field["$ref"].rpartition("/")[2])
    if "const" in field:
        return f"`{field['const']}`"
    if "enum" in field:
        return ", ".join(f"`{value}`" for value in field["enum"])
    for key in ("anyOf", "oneOf", "allOf"):
        if key in field:
            return " or ".join(dict.fromkeys(map(type_of, field[key])))
    return _plain_type(field)


def _plain_type(field: Schema) -> str:
    kind = field.get("type", "value")
    if kind == "array":
        items = field.get("items") or field.get("prefixItems", [{}])[0]
        return f"list of {type_of(items) if isinstance(items, dict) else 'values'}"
    if kind == "object":
        return _mapping(field)
    if kind == "string" and "examples" in field:
        return "quantity"
    if isinstance(kind, list):
        return " or ".join(type_of({"type": one}) for one in kind)
    return {"string": "text", "boolean": "`true` or `false`", "null": "nothing"}.get(kind, kind)


def _mapping(field: Schema) -> str:
    if names := field.get("properties"):
        return f"mapping of {', '.join(f'`{name}`' for name in names)}"
    held = (
        field.get("additionalProperties") or [*field.get("patternProperties", {}).values(), None][0]
    )
    return f"mapping of names to {type_of(held)}" if isinstance(held, dict) else "mapping"


def unit_of(field: Schema) -> str:
    """Return the unit of the first example of a quantity; any unit of its kind may be written."""
    for text in examples_in(field):
        if match := re.fullmatch(r"[-+\d./e]+ (\S+)", text):
            return match[1]
    return ""


def examples_in(field: Schema) -> Iterator[str]:
    """Yield the examples that a schema holds, those of its alternatives too."""
    yield from (text for text in field.get("examples", []) if isinstance(text, str))
    for key in ("anyOf", "oneOf", "allOf"):
        for arm in field.get(key, []):
            yield from examples_in(arm)
    for inner in field.get("properties", {}).values():
        yield from examples_in(inner)


def table(schema: Schema, heads: tuple[str, ...], row: Row) -> Iterator[str]:
    """Yield the lines of a table with one row for each property."""
    yield f"| {' | '.join(heads)} |"
    yield "|---" * len(heads) + "|"
    for key, field in schema.get("properties", {}).items():
        yield f"| {' | '.join(row(key, field))} |"


def refuse_silence(definitions: dict[str, Schema]) -> None:
    """Stop the build where a mapping or one of its keys has no meaning in words."""
    refuse(
        "keys of a schema without a description",
        (
            f"{name}.{key}"
            for name, schema in definitions.items()
            for key, field in schema.get("properties", {}).items()
            if not _says(field, definitions)
        ),
    )
    refuse(
        "mappings of a schema without a description",
        (name for name, schema in definitions.items() if not schema.get("description")),
    )


def _says(field: Schema, definitions: dict[str, Schema]) -> bool:
    """Tell whether a field has a meaning: its own, or that of what it refers to."""
    referred = definitions.get(field.get("$ref", "").rpartition("/")[2], {})
    return bool(field.get("description") or referred.get("description"))
