"""``nrs-design identify``: measured data in, models with intervals out."""

from __future__ import annotations

import typer

from nrs_design.cli.groups import CommandGroup
from nrs_design.cli.identify.actuator import actuator
from nrs_design.cli.identify.tissue import tissue

identify = typer.Typer(
    cls=CommandGroup,
    no_args_is_help=True,
    help="Identify actuator or tissue from measured records, with 95 % intervals.",
    epilog="Data are CSV files with named columns such as time_s, deflection_m, force_N.",
)
identify.command("tissue")(tissue)
identify.command("actuator")(actuator)
