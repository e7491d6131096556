"""``nrs-design robot export``: a robot for simulators."""

from __future__ import annotations

from enum import StrEnum
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli.options import Json, Quiet, SpecFile
from nrs_design.cli.printing import print_json, say
from nrs_design.exporters import ROBOT_FORMATS


class RobotFormat(StrEnum):
    """Formats by name."""

    MJCF = "mjcf"
    URDF = "urdf"


def export(
    spec: SpecFile,
    format_: Annotated[
        RobotFormat,
        typer.Option(
            "--format",
            help="mjcf: with closed loops; urdf: the tree without them.",
        ),
    ] = RobotFormat.MJCF,
    out: Annotated[Path, typer.Option(help="Folder, or the file itself with its ending.")] = Path(
        "reports"
    ),
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Export links, joints and inertias of a robot for MuJoCo, or as URDF.

    Example: nrs-design robot export specs/robots/neuroboscope.nrs.yaml --format mjcf
    """
    from nrs_design.exporters.robot_tree import RobotExport
    from nrs_design.exporters.write import places, write_files
    from nrs_design.ownership import check_export, origin_of
    from nrs_design.pipeline import placed, run_robot

    loaded, _, robot = run_robot(spec)
    chosen = ROBOT_FORMATS[format_]
    files = places(chosen, loaded.spec.name, out)
    for file in files.values():
        check_export(spec, file)
    origin = origin_of(spec, next(iter(files.values())))
    module = import_module(f"nrs_design.exporters.{chosen.module}")
    with placed(loaded):
        contents = module.render(RobotExport(loaded, robot, origin))
    write_files(chosen, files, contents)
    written = list(map(str, files.values()))
    if as_json:
        head = {"spec": loaded.spec.name, "spec_sha256": loaded.sha256}
        print_json("robot-export", {**head, "format": str(format_), "files": written})
    elif not quiet:
        say(f"{loaded.spec.name}: exported to {', '.join(written)}")
