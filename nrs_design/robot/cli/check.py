"""``nrs-design robot check``: validate a robot spec and see whether the robot can exist."""

from __future__ import annotations

import math
from typing import Any

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import insist, say
from nrs_design.cli.tables import print_blocks


@command("robot-check")
def check(spec: SpecFile) -> Answer:
    """Validate a robot spec: reach over its workspace, mass, and a sound mass matrix.

    Exit code 1: a part of the workspace that the spec declares cannot be reached.

    Example: nrs-design robot check specs/robots/neuroboscope.nrs.yaml
    """
    from nrs_design.pipeline.design import placed
    from nrs_design.robot.models.workspace import examine_inertia, survey_workspace
    from nrs_design.robot.pipeline import run_robot
    from nrs_design.robot.reporting.robot import unreachable_share, workspace_tables

    loaded, _, robot = run_robot(spec)
    with placed(loaded):
        survey = survey_workspace(robot)
        inertia = examine_inertia(robot).tolist()
    obstacle = survey.obstacle
    if obstacle is not None:
        insist(
            f"{spec}:{loaded.place('workspace').line}: {unreachable_share(survey)} of the declared "
            f"workspace cannot be reached; {obstacle.message}"
        )
    content: dict[str, Any] = {
        "moving_mass_kg": robot.moving_mass,
        "home": robot.home.tolist(),
        "reachable_share": survey.reachable,
        "obstacle": obstacle.message if obstacle else None,
        "corners": [
            {"phi_deg": math.degrees(phi), "psi_deg": math.degrees(psi), "deepest_m": depth}
            for phi, psi, depth in survey.deepest
        ],
        "mass_matrix_eigenvalues_at_home": inertia,
    }

    def show() -> None:
        say(f"{spec}: valid robot {loaded.spec.name!r}")
        eigenvalues = ", ".join(f"{value:.4g}" for value in inertia)
        say(
            f"moving mass {robot.moving_mass:.4f} kg; eigenvalues of M at home {eigenvalues} kg m^2"
        )
        if obstacle is None:
            say("every pose of a grid over the workspace is reachable by all legs")
        print_blocks(loaded.spec.name, workspace_tables(loaded, survey))

    facts = loaded.facts | {"valid": True} | content
    return Answer(lambda: facts, show, exit_codes.unless(obstacle is not None))
