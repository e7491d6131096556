"""``nrs-design robot balance``: counter-masses and springs, and what they leave."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from nrs_design.cli.command import Answer, command
from nrs_design.cli.options import SpecFile
from nrs_design.cli.tables import print_blocks, print_table


@command("robot-balance")
def balance(spec: SpecFile) -> Answer:
    """Compute the passive balance, and the torque that remains over the workspace.

    Example: nrs-design robot balance specs/robots/neuroboscope.nrs.yaml
    """
    import numpy as np

    from nrs_design.robot.models.balance import design_balance, examine_balance
    from nrs_design.robot.models.vectors import root_mean_square
    from nrs_design.robot.pipeline import run_robot
    from nrs_design.robot.reporting.robot import balance_table

    loaded, robot_spec, robot = run_robot(spec)
    design = design_balance(robot_spec, robot)
    unbalanced, balanced = (
        {"rms": root_mean_square(t).tolist(), "largest": np.abs(t).max(axis=0).tolist()}
        for t in examine_balance(robot, design)
    )
    content: dict[str, Any] = {
        "tilt": design.tilt,
        "left": asdict(design.left_leg),
        "right": asdict(design.right_leg),
        "without_balance": unbalanced,
        "with_balance": balanced,
        "units": {"mass": "kg", "distance": "m", "stiffness": "N/m", "torque": "N*m"},
    }

    def show() -> None:
        print_blocks(loaded.spec.name, [balance_table(loaded, design)])
        print_table(
            "",
            ["static torque of theta1, theta2, theta3 [N m]", "root mean square", "largest"],
            [
                [name, *(", ".join(f"{n:.3f}" for n in torque[key]) for key in torque)]
                for name, torque in (("without balance", unbalanced), ("with balance", balanced))
            ],
        )

    return Answer(lambda: loaded.facts | content, show)
