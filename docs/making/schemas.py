"""The JSON Schemas of files that the program reads and writes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import get_args

from typer.testing import CliRunner

from making.tables import Schema, cell, table, type_of
from nrs_design.cli.app import make_app
from nrs_design.cli.schema import Described

INTRODUCTION = """# JSON Schemas

For editors and for programs that read what the commands write. `nrs-design schema --of NAME` prints
each of them.
"""


def schema_names() -> tuple[str, ...]:
    """Return what ``schema --of`` knows."""
    return get_args(Described)


def schema_text(name: str) -> str:
    """Return what ``schema --of NAME`` prints."""
    result = CliRunner().invoke(make_app(), ["schema", "--of", name], catch_exceptions=False)
    return result.stdout


def schemas_page(texts: dict[str, str]) -> str:
    """Describe the schemas, with links to the files."""
    lines = [INTRODUCTION]
    for name, text in texts.items():
        schema: Schema = json.loads(text)
        lines += [f"## {name}", "", cell(schema.get("description", schema.get("title", ""))), ""]
        lines += [f"File: [{name}.schema.json]({name}.schema.json), {schema['$schema']}", ""]
        lines += [*_keys(name, schema), ""]
    return "\n".join(lines)


def _keys(name: str, schema: Schema) -> Iterator[str]:
    if name == "spec":
        yield "What it says of each key is on the page [fields of a spec](spec.md)."
        return
    required = schema.get("required", [])
    yield from table(
        schema,
        ("key", "type", "", "meaning"),
        lambda key, field: (
            f"`{key}`",
            type_of(_without_links(field)),
            "required" if key in required else "",
            cell(field.get("description", "")),
        ),
    )


def _without_links(field: Schema) -> Schema:
    """Leave out where a key refers to: that is in the file, and not on this page."""
    if "$ref" in field:
        return {"type": "object"}
    return {
        key: [_without_links(arm) for arm in value] if key in ("anyOf", "oneOf", "allOf") else value
        for key, value in field.items()
    } | ({"items": _without_links(field["items"])} if isinstance(field.get("items"), dict) else {})
