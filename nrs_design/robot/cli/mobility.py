"""``nrs-design robot mobility``: how the axes of an arm act on each other, rigorously."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile, read_work
from nrs_design.cli.printing import progress, say

if TYPE_CHECKING:
    from nrs_design.robot.models import ArmMobility

# How far beyond what is found a range is offered.
ROOM = 0.05


@command("robot-mobility")
def mobility(
    spec: SpecFile,
    budget: Annotated[
        float,
        typer.Option(metavar="WORK", parser=read_work, help="Work, in units of about a second."),
    ] = 300.0,
) -> Answer:
    """Compute the mobility of the arm that a file with several axes names, from its URDF or MJCF.

    Boxes of joint positions are halved until interval arithmetic shows that the eigenvalues of
    J^(1/2) Lambda^-1 J^(1/2) are in the declared range in each.

    Exit code 1: a pose is beyond the declared range; 3: neither was shown.

    Example: nrs-design robot mobility docs/examples/six-torques.nrs.yaml
    """
    from nrs_design.robot.pipeline import run_mobility

    with progress(f"mobility of {spec.name}") as step:
        found = run_mobility(spec, budget, step)

    def facts() -> dict[str, Any]:
        return {
            "model": found.model.as_posix(),
            "axes": list(found.axes),
            "verdict": found.verdict,
            "declared": list(found.declared),
            "found": list(found.found),
            "at": [list(q) for q in found.at],
            "joints": list(found.joints),
        }

    return Answer(facts, lambda: _show(found), exit_codes.OF_VERDICT[found.verdict])


def _show(found: ArmMobility) -> None:
    low, high = found.declared
    said = f"eigenvalues in [{low:.6g}, {high:.6g}] with {', '.join(found.axes)}"
    say(f"{found.arm}: {found.verdict.upper()}: {said}", verdict=found.verdict)
    for value, where in zip(found.found, found.where, strict=True):
        say(f"  found {value:.6g} {where}")
    if found.verdict == "refuted":
        low, high = found.found[0] * (1 - ROOM), found.found[1] * (1 + ROOM)
        say(f"next: write `mobility: [{low:.3g}, {high:.3g}]`, and see whether it is shown")
    elif found.verdict == "inconclusive":
        say("next: declare a wider range, narrow those of the joints, or give more --budget")
