"""Pages of the documentation that are made from the package: fields, commands, rules, library.

mkdocs calls the two functions that it knows by name (``on_files``, ``on_page_markdown``).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from typer.cli import get_docs_for_click

import nrs_design
from nrs_design.cli.app import make_app
from nrs_design.gating.rules import RULES, WORDS
from nrs_design.spec.load import SPEC_KINDS, model_of
from nrs_design.spec.schema import json_schema

ROOT = Path(__file__).parents[2]
Schema = dict[str, Any]


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the generated pages, and the specs that pages refer to."""
    pages = {
        "reference/spec.md": spec_page(),
        "reference/commands.md": commands_page(),
        "reference/rules.md": rules_page(),
        "reference/library.md": library_page(),
    }
    for name, text in pages.items():
        files.append(File.generated(config, name, content=text))
    for path in sorted((ROOT / "specs").rglob("*.yaml")):
        name = path.relative_to(ROOT).as_posix()
        files.append(File.generated(config, name, content=path.read_text(encoding="utf-8")))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Point links at specs, which lie beside the documentation, to their copies in it."""
    return re.sub(r"\]\(\.\./((?:\.\./)*specs/)", r"](\1", markdown)


def spec_page() -> str:
    """Describe every field of a spec: what it is, what type it has, and its unit."""
    definitions: dict[str, Schema] = json_schema()["definitions"]
    lines = [
        "# Fields of a spec",
        "",
        "Made from the models that read the files; `nrs-design schema` writes the same as JSON "
        "Schema, for editors. A quantity is a number with its unit, such as `0.24 m`; every "
        "number is exactly the decimal or ratio that is written. A key that is not listed is an "
        "error.",
        "",
    ]
    roots = {model_of(kind).__name__: kind for kind in SPEC_KINDS}
    for name in [*roots, *(name for name in definitions if name not in roots)]:
        title = f"kind: {roots[name]}" if name in roots else name.removesuffix("Spec")
        lines += [f"## {title} {{ #{name.lower()} }}", "", *_definition(definitions[name]), ""]
    return "\n".join(lines)


def _definition(schema: Schema) -> Iterator[str]:
    yield _cell(schema.get("description", "").partition("\n")[0])
    yield ""
    yield "| key | type | | meaning |"
    yield "|---|---|---|---|"
    required = schema.get("required", [])
    for key, field in schema.get("properties", {}).items():
        needed = "required" if key in required else ""
        yield f"| `{key}` | {_type(field)} | {needed} | {_cell(field.get('description', ''))} |"


def _type(field: Schema) -> str:
    """Name a type in words, with links to the fields of mappings."""
    if "$ref" in field:
        name = field["$ref"].rpartition("/")[2]
        return f"[{name.removesuffix('Spec')}](#{name.lower()})"
    if "const" in field:
        return f"`{field['const']}`"
    if "enum" in field:
        return ", ".join(f"`{value}`" for value in field["enum"])
    for key in ("anyOf", "oneOf", "allOf"):
        if key in field:
            return " or ".join(dict.fromkeys(map(_type, field[key])))
    kind = field.get("type", "value")
    if kind == "array":
        items = field.get("items") or field.get("prefixItems", [{}])[0]
        return f"list of {_type(items) if isinstance(items, dict) else 'values'}"
    if kind == "object":
        held = field.get("additionalProperties")
        return f"mapping of names to {_type(held)}" if isinstance(held, dict) else "mapping"
    if kind == "string" and "examples" in field:
        return f"text such as `{field['examples'][0]}`"
    return {"string": "text", "boolean": "`true` or `false`"}.get(kind, kind)


def _cell(text: str) -> str:
    return text.replace("``", "`").replace("|", "\\|").replace("\n", " ")


def commands_page() -> str:
    """Describe every command with its arguments and options, as ``--help`` does."""
    command = typer.main.get_command(make_app())
    context = typer.Context(command, info_name="nrs-design")
    text = get_docs_for_click(obj=command, ctx=context, name="nrs-design")
    # Options of completion are of the shell, and tags would be read as HTML.
    return f"# Commands\n\n{text.partition(chr(10))[2]}"


def rules_page() -> str:
    """Describe every rule and verdict."""
    lines = ["# Rules and verdicts", "", "`nrs-design explain RULE` prints the same.", ""]
    for rule in RULES.values():
        lines += [f"## {rule.id}: {rule.title}", "", rule.explanation, ""]
        lines += [f"**What to do:** {rule.remedy}", ""]
    for word in WORDS.values():
        lines += [f"## {word.word}", "", word.explanation, "", f"**What to do:** {word.remedy}", ""]
    return "\n".join(lines)


def library_page() -> str:
    """Describe what ``import nrs_design as nrs`` offers."""
    lines = ["# Library", "", "`import nrs_design as nrs` offers:", ""]
    for name in nrs_design.__all__:
        # Where it is defined: what is documented by another name loses its parameters.
        lines += [f"::: {getattr(nrs_design, name).__module__}.{name}", ""]
    return "\n".join(lines)
