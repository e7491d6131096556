"""``nrs-design ros2``: parameter files of controllers of ROS 2."""

from __future__ import annotations

import typer

from nrs_design.cli.groups import CommandGroup
from nrs_design.cli.ros2.check import check

ros2 = typer.Typer(
    name="ros2",
    cls=CommandGroup,
    no_args_is_help=True,
    help="Check the parameters of controllers of ROS 2; no ROS is needed.",
)
ros2.command("check")(check)


@ros2.callback()
def _group() -> None:
    """Hold the commands: without it, Typer takes a single command for the group."""


__all__ = ["ros2"]
