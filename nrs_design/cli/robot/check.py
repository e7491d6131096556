"""``nrs-design robot check``: validate a robot spec and see whether the robot can exist."""

from __future__ import annotations

from nrs_design.cli.options import Json, Quiet, SpecFile
from nrs_design.cli.printing import print_json, print_table


def check(spec: SpecFile, as_json: Json = False, quiet: Quiet = False) -> None:
    """Validate a robot spec: reach over its workspace, mass, and a sound mass matrix.

    Example: nrs-design robot check specs/robots/neuroboscope.nrs.yaml
    """
    import numpy as np

    from nrs_design.models.robot import mass_matrix, survey_workspace
    from nrs_design.pipeline import run_robot

    loaded, _, robot = run_robot(spec)
    survey = survey_workspace(robot)
    inertia = np.linalg.eigvalsh(mass_matrix(robot, robot.home))
    mass = sum(body.mass for loads in robot.loads for body in loads)
    corners = [
        {"phi_deg": float(np.degrees(phi)), "psi_deg": float(np.degrees(psi)), "deepest_m": depth}
        for phi, psi, depth in survey.deepest
    ]
    if as_json:
        print_json(
            "robot-check",
            {
                "spec": loaded.spec.name,
                "spec_sha256": loaded.sha256,
                "valid": True,
                "moving_mass_kg": mass,
                "home": list(map(float, robot.home)),
                "reachable_share": survey.reachable,
                "corners": corners,
                "mass_matrix_eigenvalues_at_home": list(map(float, inertia)),
            },
        )
        return
    print(f"{spec}: valid robot {loaded.spec.name!r}")
    if quiet:
        return
    print(f"moving mass {mass:.4f} kg; eigenvalues of M at home {_list(inertia)} kg m^2")
    print(f"{100 * survey.reachable:.2f} % of the workspace grid is reachable by all legs")
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


def _list(numbers: object) -> str:
    import numpy as np

    return ", ".join(f"{number:.4g}" for number in np.ravel(np.asarray(numbers, dtype=float)))
