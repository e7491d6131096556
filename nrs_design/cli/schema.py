"""``nrs-design schema``: the JSON Schema of spec files, for editors."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli.options import Quiet
from nrs_design.cli.printing import note


def schema(
    out: Annotated[Path | None, typer.Option(help="Write to a file instead of stdout.")] = None,
    quiet: Quiet = False,
) -> None:
    """Print the JSON Schema (draft-07) of spec files.

    Example: nrs-design schema --out nrs.schema.json
    """
    from nrs_design.output import SCHEMA, write_output
    from nrs_design.spec.schema import schema_text

    text = schema_text()
    if out is None:
        sys.stdout.write(text)
        return
    write_output(out, text, replaces=SCHEMA)
    note(f"schema written to {out}", quiet=quiet)
