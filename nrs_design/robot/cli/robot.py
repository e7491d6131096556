"""``nrs-design robot``: kinematics, dynamics, balance and motion control of a robot."""

from __future__ import annotations

import typer

from nrs_design.robot.cli.balance import balance
from nrs_design.robot.cli.check import check
from nrs_design.robot.cli.correction import correction
from nrs_design.robot.cli.dynamics import dynamics
from nrs_design.robot.cli.kinematics import kinematics
from nrs_design.robot.cli.track import track

robot = typer.Typer(
    name="robot",
    no_args_is_help=True,
    help="Kinematics, dynamics, balance and motion control of a robot (specs of kind robot).",
    epilog="The page of a robot: nrs-design report SPEC.",
)
for subcommand in (check, kinematics, dynamics, correction, balance, track):
    robot.command(subcommand.__name__)(subcommand)
