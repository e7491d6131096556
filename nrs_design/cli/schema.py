"""``nrs-design schema``: the JSON Schema of spec files, for editors, and of export records."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import note

# Schemas that the command prints.
Described = Literal["spec", "export"]


@command("schema", has_json=False)
def schema(
    document: Annotated[
        Described,
        typer.Option("--of", help="Of spec files (draft-07), or of export records (2020-12)."),
    ] = "spec",
    out: Annotated[Path | None, typer.Option(help="Write to a file instead of stdout.")] = None,
) -> Answer:
    """Print the JSON Schema of spec files, or of what `export` writes.

    Example: nrs-design schema --out nrs.schema.json

    Example: nrs-design schema --of export
    """
    from nrs_design.exporters.record import record_schema_text
    from nrs_design.output import SCHEMA, write_output
    from nrs_design.spec.schema import schema_text

    text = record_schema_text() if document == "export" else schema_text()
    if out is None:
        sys.stdout.write(text)
    else:
        write_output(out, text, replaces=SCHEMA)
        note(f"schema written to {out}")
    return Answer()
