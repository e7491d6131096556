"""``nrs-design robot check``: validate a robot spec and see whether the robot can exist."""

from __future__ import annotations

import math
from typing import Any

from nrs_design.cli import exit_codes
from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.printing import insist, say
from nrs_design.cli.tables import print_table


@command("robot-check")
def check(spec: SpecFile) -> Answer:
    """Validate a robot spec: reach over its workspace, mass, and a sound mass matrix.

    Exit code 1: a part of the workspace that the spec declares cannot be reached.

    Example: nrs-design robot check specs/robots/neuroboscope.nrs.yaml
    """
    from nrs_design.pipeline.design import placed
    from nrs_design.robot.models.workspace import examine_inertia, survey_workspace
    from nrs_design.robot.pipeline import run_robot

    loaded, _, robot = run_robot(spec)
    with placed(loaded):
        survey = survey_workspace(robot)
        inertia = examine_inertia(robot).tolist()
    if survey.obstacle is not None:
        place = loaded.place("workspace")
        insist(
            f"{spec}:{place.line}: {_share(1 - survey.reachable)} of the declared workspace cannot "
            f"be reached; {survey.obstacle.message}"
        )

    content: dict[str, Any] = {
        "moving_mass_kg": robot.moving_mass,
        "home": robot.home.tolist(),
        "reachable_share": survey.reachable,
        "obstacle": survey.obstacle.message if survey.obstacle else None,
        "corners": [
            {"phi_deg": math.degrees(phi), "psi_deg": math.degrees(psi), "deepest_m": depth}
            for phi, psi, depth in survey.deepest
        ],
        "mass_matrix_eigenvalues_at_home": inertia,
    }

    def show() -> None:
        say(f"{spec}: valid robot {loaded.spec.name!r}")
        _print(content)

    return Answer(
        lambda: {**loaded.facts, "valid": True, **content},
        show,
        exit_codes.unless(survey.obstacle is not None),
    )


def _share(fraction: float) -> str:
    """Write a share of unreachable poses in percent, rounded up."""
    return f"{math.ceil(1e4 * fraction) / 100:g} %"


def _print(content: dict[str, Any]) -> None:
    mass, inertia = content["moving_mass_kg"], content["mass_matrix_eigenvalues_at_home"]
    eigenvalues = ", ".join(f"{value:.4g}" for value in inertia)
    say(f"moving mass {mass:.4f} kg; eigenvalues of M at home {eigenvalues} kg m^2")
    if content["obstacle"] is None:
        say("every pose of a grid over the workspace is reachable by all legs")
    print_table(
        "",
        ["phi", "psi", "deepest reachable"],
        [
            [
                f"{corner['phi_deg']:.4g} deg",
                f"{corner['psi_deg']:.4g} deg",
                "no depth" if (depth := corner["deepest_m"]) is None else f"{1e3 * depth:.1f} mm",
            ]
            for corner in content["corners"]
        ],
    )
