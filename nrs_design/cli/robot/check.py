"""``nrs-design robot check``: validate a robot spec and see whether the robot can exist."""

from __future__ import annotations

from nrs_design.cli.options import Json, Quiet, SpecFile
from nrs_design.cli.printing import print_json, say
from nrs_design.cli.tables import print_table


def check(spec: SpecFile, as_json: Json = False, quiet: Quiet = False) -> None:
    """Validate a robot spec: reach over its workspace, mass, and a sound mass matrix.

    Example: nrs-design robot check specs/robots/neuroboscope.nrs.yaml
    """
    import math

    from nrs_design.models.robot import examine_inertia, survey_workspace
    from nrs_design.pipeline import run_robot

    loaded, _, robot = run_robot(spec)
    survey = survey_workspace(robot)
    inertia = examine_inertia(robot).tolist()
    corners = [
        {"phi_deg": math.degrees(phi), "psi_deg": math.degrees(psi), "deepest_m": depth}
        for phi, psi, depth in survey.deepest
    ]
    if as_json:
        print_json(
            "robot-check",
            {
                "spec": loaded.spec.name,
                "spec_sha256": loaded.sha256,
                "valid": True,
                "moving_mass_kg": robot.moving_mass,
                "home": robot.home.tolist(),
                "reachable_share": survey.reachable,
                "corners": corners,
                "mass_matrix_eigenvalues_at_home": inertia,
            },
        )
        return
    say(f"{spec}: valid robot {loaded.spec.name!r}")
    if quiet:
        return
    eigenvalues = ", ".join(f"{value:.4g}" for value in inertia)
    say(f"moving mass {robot.moving_mass:.4f} kg; eigenvalues of M at home {eigenvalues} kg m^2")
    say(f"{100 * survey.reachable:.2f} % of the workspace grid is reachable by all legs")
    print_table(
        "",
        ["phi", "psi", "deepest reachable"],
        [
            [
                f"{corner['phi_deg']:.4g} deg",
                f"{corner['psi_deg']:.4g} deg",
                "none" if (depth := corner["deepest_m"]) is None else f"{1e3 * depth:.1f} mm",
            ]
            for corner in corners
        ],
    )
