"""Every field of a spec: type, unit, default, meaning, and where an example of it stands."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from making.examples import Example, examples_of
from making.tables import Schema, cell, examples_in, refuse_silence, table, type_of, unit_of
from nrs_design.spec.load import SPEC_KINDS, model_of
from nrs_design.spec.schema import json_schema

HEADS = ("key", "meaning", "type", "unit", "default", "example")
INTRODUCTION = """# Fields of a spec

Made from the models that read the files; `nrs-design schema` writes the same as JSON Schema, for
editors. A quantity is a number with its unit, such as `0.24 m`: any unit of the same kind may be
written, the table has one that is usual. Every number is exactly the decimal or ratio that is
written. A key that is not listed is an error. Examples are taken from specs that the tests run;
their links lead there.
"""


def spec_page(specs: list[tuple[str, Path]], definitions: dict[str, Schema] | None = None) -> str:
    """Describe every field of a spec."""
    definitions = definitions or json_schema()["definitions"]
    refuse_silence(definitions)
    roots = {model_of(kind).__name__: kind for kind in SPEC_KINDS}
    defaults, examples = _defaults(), examples_of(specs, definitions, roots)
    lines = [INTRODUCTION]
    for name in [*roots, *(name for name in definitions if name not in roots)]:
        title = f"kind: {roots[name]}" if name in roots else name.removesuffix("Spec")
        lines += [f"## {title} {{ #{name.lower()} }}", ""]
        lines += [cell(definitions[name]["description"].partition("\n")[0]), ""]
        lines += [*_fields(name, definitions[name], defaults, examples), ""]
    return "\n".join(lines)


def _fields(
    name: str,
    schema: Schema,
    defaults: dict[tuple[str, str], str],
    examples: dict[tuple[str, str], Example],
) -> Iterator[str]:
    required = schema.get("required", [])

    def row(key: str, field: Schema) -> tuple[str, ...]:
        unit = unit_of(field)
        example = examples.get((name, key))
        return (
            f"`{key}`",
            cell(field.get("description", "")),
            type_of(field),
            f"`{unit}`" if unit else "",
            "required" if key in required else defaults.get((name, key), ""),
            f"[`{cell(example.text)}`]({example.link})" if example else _given(field),
        )

    return table(schema, HEADS, row)


def _given(field: Schema) -> str:
    """Return what the schema itself shows, where no spec has an example."""
    shown = [*examples_in(field), *field.get("enum", []), field.get("const", "")]
    return f"`{shown[0]}`" if shown[0] else ""


def _defaults() -> dict[tuple[str, str], str]:
    """Return what holds where a key is left out, if it is a value; others say it in words."""
    found: dict[tuple[str, str], str] = {}
    for kind in SPEC_KINDS:
        schema = model_of(kind).model_json_schema()
        for name, part in {**schema.get("$defs", {}), model_of(kind).__name__: schema}.items():
            for key, field in part.get("properties", {}).items():
                value = field.get("default")
                if value not in (None, "", [], {}):
                    text = value["text"] if isinstance(value, dict) else str(value).lower()
                    found[name, key] = f"`{text}`"
    return found
