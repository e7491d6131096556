"""``nrs-design identify``: measured data in, models with intervals out."""

from __future__ import annotations

import typer

from nrs_design.cli.groups import CommandGroup
from nrs_design.identification.cli.identify.actuator import actuator
from nrs_design.identification.cli.identify.delay import delay
from nrs_design.identification.cli.identify.tissue import tissue

identify = typer.Typer(
    cls=CommandGroup,
    no_args_is_help=True,
    help="Identify actuator, tissue or delay from measured records, with 95 % intervals.",
    epilog="Data are text (CSV and the like), with columns named by quantity and unit, "
    "such as time_s, deflection_m, 'Force [N]'; --map names others.",
)
identify.command("tissue")(tissue)
identify.command("actuator")(actuator)
identify.command("delay")(delay)
