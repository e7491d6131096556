"""``nrs-design robot bounds``: what the links do to the axes at most, over a whole workspace."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile, read_work
from nrs_design.cli.printing import note, progress, say
from nrs_design.cli.tables import print_table
from nrs_design.robot.cli.options import Figures, write_figures

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nrs_design.robot.models import Enclosed, Robot, Space

# Rows of the table: key, what is said, and on which side the bound is.
_ROWS = (
    ("heaviest", "largest eigenvalue of M [kg m^2]"),
    ("lightest", "smallest eigenvalue of M [kg m^2]"),
    ("velocity_torques", "Coriolis torque over speed squared [N m s^2/rad^2]"),
    ("gravity_gradient", "gradient of gravity torques [N m/rad]"),
)


@command("robot-bounds")
def bounds(
    spec: SpecFile,
    phi: Annotated[
        float | None, typer.Option(metavar="DEG", help="Largest |phi|; default: the spec's.")
    ] = None,
    psi: Annotated[
        float | None, typer.Option(metavar="DEG", help="Largest |psi|; default: the spec's.")
    ] = None,
    depth: Annotated[
        str | None,
        typer.Option(metavar="MIN,MAX", help="Range of d in mm; default: the spec's."),
    ] = None,
    budget: Annotated[
        float,
        typer.Option(
            metavar="WORK",
            parser=read_work,
            help="Work for each of the four bounds: boxes, counted in units of about a second.",
        ),
    ] = 1800.0,
    write: Annotated[
        bool,
        typer.Option("--write", help="Write them beside the spec, as arm.bounds.json."),
    ] = False,
    check: Annotated[
        bool,
        typer.Option("--check", help="Compute again what the file beside the spec claims."),
    ] = False,
    figures: Figures = None,
) -> Answer:
    """Bound inertia, Coriolis torques and gravity of the links over a workspace, rigorously.

    Boxes of poses are halved until interval arithmetic shows each of them to be below a goal, which
    is somewhat above the largest value that was found at a pose. Both are printed. All poses of the
    workspace must be reachable.

    With --write, specs that name the robot under `coupling` are certified with these bounds.

    Exit code 1, with --check: the file claims what does not hold.

    Example: nrs-design robot bounds specs/robots/neuroboscope.nrs.yaml --phi 13 --psi 18
    --depth 155,235
    """
    if check:
        return _check(spec, budget)
    from nrs_design import __version__
    from nrs_design.output import BOUNDS, check_place, write_output
    from nrs_design.pipeline import placed
    from nrs_design.printable import json_text
    from nrs_design.robot.models import Space, bounds_document, compute_bounds
    from nrs_design.robot.pipeline import run_robot
    from nrs_design.spec.robot_bounds import bounds_file

    file = bounds_file(spec) if write else None
    if file is not None:
        check_place(file, BOUNDS)
    loaded, _, robot = run_robot(spec)
    space = _narrowed(Space.of(robot.workspace), phi, psi, depth)
    with placed(loaded), progress(f"bounds of {loaded.spec.name}", lines=True) as step:
        found = compute_bounds(robot, space, budget, step)
    document = bounds_document(loaded.spec.name, loaded.sha256, space, found, __version__)
    files = _draw(figures, robot, space, found) if figures is not None else []
    if file is not None:
        write_output(file, json_text(document) + "\n", replaces=BOUNDS)
        note(f"written to {file}")
    content = {key: value for key, value in document.items() if key != "schema"}
    content |= {"file": file and str(file), "files": files}
    return Answer(lambda: content, lambda: _print(document))


def _check(spec: Path, budget: float) -> Answer:
    from nrs_design.robot.pipeline import check_robot_bounds

    with progress(f"bounds of {spec.name}", lines=True) as step:
        file, faults = check_robot_bounds(spec, budget, step)

    def show() -> None:
        if not faults:
            say(f"{file} holds: every bound was computed again")
            return
        say(f"REJECTED: {file} claims what does not hold", verdict="rejected")
        for fault in faults:
            say(f"  {fault}")

    facts = {"file": str(file), "faults": list(faults)}
    code = exit_codes.unless(faults)
    return Answer(lambda: facts, show, code, loud=bool(faults), name="robot-bounds-check")


def _narrowed(space: Space, phi: float | None, psi: float | None, depth: str | None) -> Space:
    """Replace what the user gives."""
    for name, angle in (("phi", phi), ("psi", psi)):
        if angle is not None and not 0 < angle < 60:
            raise typer.BadParameter("give degrees between 0 and 60", param_hint=f"--{name}")
    if depth is not None:
        low, comma, high = depth.partition(",")
        try:
            ordered = bool(comma) and 0 < float(low) < float(high)
        except ValueError:
            ordered = False
        if not ordered:
            raise typer.BadParameter(
                f"{depth!r} is not two depths in mm, the smaller first, such as 155,235",
                param_hint="--depth",
            )
        space = replace(space, d=(f"{float(low):.10g}", f"{float(high):.10g}"))
    return replace(
        space,
        phi=space.phi if phi is None else f"{phi:.10g}",
        psi=space.psi if psi is None else f"{psi:.10g}",
    )


def _print(document: Mapping[str, Any]) -> None:
    from nrs_design.spec.robot_bounds import workspace_text

    say(f"all poses with {workspace_text(document)}")
    rows = []
    for key, title in _ROWS:
        found, bound = document["found"][key], document["bounds"][key]
        pose = f"{found['phi_deg']} deg, {found['psi_deg']} deg, {found['d_mm']} mm"
        rows.append([title, bound, found["value"], pose, str(found["boxes"])])
    print_table("", ["quantity", "bound (shown)", "found", "at phi, psi, d", "boxes"], rows)


def _draw(figures: Path, robot: Robot, space: Space, found: Mapping[str, Enclosed]) -> list[str]:
    from nrs_design.robot.reporting.figures.robot_bounds import draw_bounds

    return write_figures(figures, {"bounds": draw_bounds(robot, space, found)})
