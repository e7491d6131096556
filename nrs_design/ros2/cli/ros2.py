"""``nrs-design ros2``: parameter files of controllers of ROS 2."""

from __future__ import annotations

import typer

from nrs_design.ros2.cli.check import check
from nrs_design.ros2.cli.export import export

ros2 = typer.Typer(
    name="ros2",
    no_args_is_help=True,
    help="Check and write the parameters of controllers of ROS 2; no ROS is needed.",
)
ros2.command("check")(check)
ros2.command("export")(export)
