"""``nrs-design robot export``: a robot for simulators, and its motion control for a processor."""

from __future__ import annotations

from enum import StrEnum
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import note, progress, say
from nrs_design.errors import NrsDesignError
from nrs_design.exporters import ROBOT_FORMATS, Format
from nrs_design.facts.spec import spec_facts

INCONCLUSIVE = "inconclusive"


class RobotFormat(StrEnum):
    """Formats by name, from their table."""

    _ignore_ = "name"
    MJCF = "mjcf"
    for name in ROBOT_FORMATS:
        if name != "mjcf":
            vars()[name.upper()] = name


@command("robot-export")
def export(
    spec: SpecFile,
    format_: Annotated[
        RobotFormat,
        typer.Option(
            "--format",
            help="mjcf: with closed loops; urdf: the tree without them; c: motion control; "
            "vectors: tests of it.",
        ),
    ] = RobotFormat.MJCF,
    out: Annotated[
        Path, typer.Option(help="Folder; for a format of one file also that file, with its ending.")
    ] = Path("reports"),
    unproved: Annotated[
        bool,
        typer.Option(
            "--unproved",
            help="Export a program or its vectors, of which nothing is proved; its files say so, "
            "and the exit code stays 3.",
        ),
    ] = False,
) -> Answer:
    """Export links, joints and inertias of a robot for MuJoCo or as URDF, or its control in C.

    No certificate covers the nonlinear dynamics of three axes: C and vectors are written with
    --unproved only, and the exit code is 3 with or without it.

    Example: nrs-design robot export specs/robots/neuroboscope.nrs.yaml --format mjcf

    Example: nrs-design robot export specs/robots/neuroboscope.nrs.yaml --format c --unproved
    """
    from nrs_design.exporters.write import check_places, places, write_files
    from nrs_design.ownership import check_export, origin_of
    from nrs_design.pipeline import placed
    from nrs_design.robot.exporters.c import UNPROVED
    from nrs_design.robot.exporters.robot_tree import RobotExport
    from nrs_design.robot.pipeline import run_robot

    chosen = ROBOT_FORMATS[format_]
    _check_unproved(chosen, unproved=unproved)
    loaded, _, robot = run_robot(spec)
    files = places(chosen, loaded.spec.name, out)
    check_places(chosen, files)
    for file in files.values():
        check_export(spec, file)
    origin = origin_of(spec, next(iter(files.values())))
    written: list[str] = []
    if unproved or not chosen.executable:
        module = import_module(f"nrs_design.robot.exporters.{format_}")
        with progress(f"exporting {loaded.spec.name}"), placed(loaded):
            contents = module.render(RobotExport(loaded, robot, origin))
        write_files(chosen, files, contents)
        written = list(map(str, files.values()))
    verdict = {"verdict": INCONCLUSIVE} if chosen.executable else {}
    facts = {**spec_facts(loaded), "format": str(format_), "files": written, **verdict}

    def show() -> None:
        name = loaded.spec.name
        if written:
            unproved_text = f"UNPROVED ({UNPROVED}), " if chosen.executable else ""
            say(f"{name}: {unproved_text}exported to {', '.join(written)}")
        else:
            note(f"{name}: not exported: {UNPROVED} (--unproved exports it and says so)")

    code = exit_codes.INCONCLUSIVE if chosen.executable else exit_codes.PROVED
    # That nothing was written is an error of its own.
    return Answer(lambda: facts, show, code, loud=not written)


def _check_unproved(chosen: Format, *, unproved: bool) -> None:
    if unproved and not chosen.executable:
        raise NrsDesignError(
            "--unproved is for programs, and this format is not one",
            remedy="leave it out; `nrs-design export --list` lists the formats",
        )
