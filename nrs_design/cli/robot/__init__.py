"""``nrs-design robot``: kinematics, dynamics, balance and motion control of a robot."""

from __future__ import annotations

import typer

from nrs_design.cli.groups import CommandGroup
from nrs_design.cli.robot.balance import balance
from nrs_design.cli.robot.bounds import bounds
from nrs_design.cli.robot.check import check
from nrs_design.cli.robot.correction import correction
from nrs_design.cli.robot.dynamics import dynamics
from nrs_design.cli.robot.export import export
from nrs_design.cli.robot.kinematics import kinematics
from nrs_design.cli.robot.track import track

robot = typer.Typer(
    name="robot",
    cls=CommandGroup,
    no_args_is_help=True,
    help="Kinematics, dynamics, balance and motion control of a robot (specs of kind robot).",
    epilog="The page of a robot: nrs-design report SPEC.",
)
# A new capability of the robot adds its command here.
robot.command("check")(check)
robot.command("kinematics")(kinematics)
robot.command("dynamics")(dynamics)
robot.command("correction")(correction)
robot.command("balance")(balance)
robot.command("bounds")(bounds)
robot.command("track")(track)
robot.command("export")(export)

__all__ = ["robot"]
