"""``nrs-design robot mobility``: how the axes of an arm act on each other, rigorously."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile, read_work
from nrs_design.cli.printing import progress, say

if TYPE_CHECKING:
    from nrs_design.robot.mobility import ArmInUse, FoundMobility


@command("robot-mobility")
def mobility(
    spec: SpecFile,
    budget: Annotated[
        float,
        typer.Option(metavar="WORK", parser=read_work, help="Work, in units of about a second."),
    ] = 300.0,
) -> Answer:
    """Compute the mobility of the arm that a file with several axes names, from its URDF.

    Boxes of joint positions are halved until interval arithmetic shows that the eigenvalues of
    J^(1/2) Lambda^-1 J^(1/2) are in the declared range in each.

    Exit code 1: a pose is beyond the declared range; 3: neither was shown.

    Example: nrs-design robot mobility docs/examples/six-torques.nrs.yaml
    """
    from nrs_design.robot.mobility import faults_of, find_mobility, read_arm_in_use, show_mobility

    use = read_arm_in_use(spec)
    with progress(f"mobility of {use.arm.name}") as step:
        step("looking for the extremes")
        found = find_mobility(use)
        faults = faults_of(use)
        shown = not faults and show_mobility(use, use.declared, budget, step)
    verdict = "refuted" if faults else "proved" if shown else "inconclusive"

    def facts() -> dict[str, Any]:
        return {
            "urdf": use.urdf.as_posix(),
            "axes": list(use.names),
            "verdict": verdict,
            "declared": list(use.declared),
            "found": [found.lowest, found.highest],
            "at": [list(map(float, q)) for q in (found.at_lowest, found.at_highest)],
            "joints": [joint.name for joint in use.arm.joints],
        }

    return Answer(facts, lambda: _show(use, found, verdict), exit_codes.OF_VERDICT[verdict])


def _show(use: ArmInUse, found: FoundMobility, verdict: str) -> None:
    from nrs_design.robot.mobility import ROOM, pose

    low, high = use.declared
    said = f"eigenvalues in [{low:.6g}, {high:.6g}]"
    say(f"{use.arm.name}: {verdict.upper()}: {said} with {', '.join(use.names)}", verdict=verdict)
    say(f"  found {found.lowest:.6g} {pose(use, found.at_lowest)}")
    say(f"  found {found.highest:.6g} {pose(use, found.at_highest)}")
    if verdict == "refuted":
        wide = (found.lowest * (1 - ROOM), found.highest * (1 + ROOM))
        say(f"next: write `mobility: [{wide[0]:.3g}, {wide[1]:.3g}]`, and see whether it is shown")
    elif verdict == "inconclusive":
        say("next: declare a wider range, narrow those of the joints, or give more --budget")
