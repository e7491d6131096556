"""``nrs-design init``: a commented spec to start from."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli.options import Quiet
from nrs_design.cli.printing import note
from nrs_design.errors import OutputError


class TemplateOption(StrEnum):
    """Templates by name."""

    INTERACTION_DESIGN = "interaction-design"
    HYBRID_FORCE = "hybrid-force"
    SWITCHED_SYSTEM = "switched-system"
    ROBOT = "robot"


def init(
    template: Annotated[TemplateOption, typer.Argument(metavar="TEMPLATE", show_choices=True)],
    out: Annotated[
        Path | None, typer.Option(help="File to write; default TEMPLATE.nrs.yaml.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
    quiet: Quiet = False,
) -> None:
    """Write a commented spec (interaction-design, hybrid-force, switched-system or robot).

    Example: nrs-design init interaction-design --out my-robot.nrs.yaml
    """
    from nrs_design.output import write_output
    from nrs_design.spec.templates import TEMPLATES

    path = out or Path(f"{template}.nrs.yaml")
    if path.exists() and not force:
        raise OutputError("exists already", path=path, remedy="name another file, or add --force")
    write_output(path, TEMPLATES[str(template)])
    note(f"{path} written; for help in your editor: nrs-design schema --out nrs.schema.json")
