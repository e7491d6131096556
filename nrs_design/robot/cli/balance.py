"""``nrs-design robot balance``: counter-masses and springs, and what they leave."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.tables import print_table

_COLUMNS = {
    "arm_mass": ("M_c [g]", 1e3),
    "coupler_mass": ("M_b [g]", 1e3),
    "total_mass": ("M_a [g]", 1e3),
    "total_distance": ("B_a [mm]", 1e3),
    "stiffness": ("k [N/mm]", 1e-3),
}


@command("robot-balance")
def balance(
    spec: SpecFile,
) -> Answer:
    """Compute the passive balance, and the torque that remains over the workspace.

    Example: nrs-design robot balance specs/robots/neuroboscope.nrs.yaml
    """
    from nrs_design.robot.models.balance import design_balance, examine_balance
    from nrs_design.robot.pipeline import run_robot

    loaded, robot_spec, robot = run_robot(spec)
    wanted = design_balance(robot_spec, robot)
    torques = examine_balance(robot, wanted)
    content: dict[str, Any] = {
        "tilt": wanted.tilt,
        "left": asdict(wanted.left),
        "right": asdict(wanted.right),
        "without_balance": torques.summary(torques.gravity),
        "with_balance": torques.summary(torques.residual),
        "units": {"mass": "kg", "distance": "m", "stiffness": "N/m", "torque": "N*m"},
    }
    return Answer(lambda: loaded.facts | content, lambda: _print(content))


def _print(content: dict[str, Any]) -> None:
    print_table(
        "",
        ["leg", *(title for title, _ in _COLUMNS.values())],
        [
            [leg, *(f"{factor * content[leg][key]:.5g}" for key, (_, factor) in _COLUMNS.items())]
            for leg in ("left", "right")
        ],
    )
    print_table(
        "",
        ["static torque of theta1, theta2, theta3 [N m]", "root mean square", "largest"],
        [
            [name.replace("_", " "), *(_list(content[name][key]) for key in ("rms", "largest"))]
            for name in ("without_balance", "with_balance")
        ],
    )


def _list(numbers: list[float]) -> str:
    return ", ".join(f"{number:.3f}" for number in numbers)
