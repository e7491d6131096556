"""``nrs-design init``: a commented spec to start from."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated, Literal, get_args

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.printing import note
from nrs_design.errors import OutputError

# As the first line of every template says.
SCHEMA = "nrs.schema.json"
Template = Literal["interaction-design", "hybrid-force", "task-space", "switched-system", "robot"]


@command("init", has_json=False)
def init(
    template: Annotated[
        Template,
        typer.Argument(
            metavar="TEMPLATE",
            show_choices=False,
            help=f"What to start from: {', '.join(get_args(Template))}.",
        ),
    ],
    drive: Annotated[
        Literal["motor", "velocity", "position", "torque"],
        typer.Option(
            metavar="DRIVE",
            help="Of an interaction-design: motor, with a loop around it; or velocity, position or "
            "torque, which a robot takes.",
        ),
    ] = "motor",
    axis: Annotated[
        Literal["rotary", "prismatic"],
        typer.Option(
            help="Of an interaction-design: it turns, or it slides. Over torques, write `axis: "
            "prismatic` into the file."
        ),
    ] = "rotary",
    out: Annotated[
        Path | None, typer.Option(help="File to write; default TEMPLATE.nrs.yaml.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
) -> Answer:
    """Write a commented spec: a design, several axes, matrices or a robot.

    The spec is named after its file, so that several can stand in one folder. The schema that its
    first line names for editors is written beside it, unless it is there.

    Example: nrs-design init interaction-design --out my-robot.nrs.yaml
    """
    from nrs_design.output import write_output
    from nrs_design.spec.schema import schema_text
    from nrs_design.spec.templates import PRISMATIC, TEMPLATES

    template_name: str = template
    if drive != "motor":
        if template != "interaction-design":
            raise typer.BadParameter("it is for interaction-design", param_hint="--drive")
        template_name = f"{drive}-interface"
    if axis == "prismatic":
        if template_name not in PRISMATIC:
            raise typer.BadParameter(
                "it is for an interaction-design with a motor, or over velocities or positions; in "
                "another, write `axis: prismatic`, and quantities in m, N and kg",
                param_hint="--axis",
            )
        template_name = PRISMATIC[template_name]
    path = out or Path(f"{template}.nrs.yaml")
    if path.exists() and not force:
        raise OutputError("exists already", path=path, remedy="name another file, or add --force")
    write_output(path, named_after(path, TEMPLATES[template_name]))
    note(f"{path} written")
    schema = path.with_name(SCHEMA)
    if not schema.exists():
        write_output(schema, schema_text())
        note(f"{schema} written, for help in your editor")
    return Answer()


def named_after(path: Path, template: str) -> str:
    """Name a spec after its file, as far as the file's name can be a spec's."""
    stem = path.name.removesuffix(".yaml").removesuffix(".yml").removesuffix(".nrs").lower()
    name = re.sub("[^a-z0-9._-]+", "-", stem).strip("._-")[:64]
    if not name:
        return template
    # The comment behind the name stays in its column.
    line = re.compile("^name: ([^ ]+)( *)", re.MULTILINE)
    return line.sub(lambda m: f"name: {name} ".ljust(len(m[0])), template, count=1)
