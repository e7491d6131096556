"""``nrs-design identify tool``: mass, center of mass and bias of what hangs on the sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.options import Date, ReportTo
from nrs_design.cli.printing import progress, say
from nrs_design.identification.cli.identify.common import (
    ColumnMap,
    DataFiles,
    WriteTo,
    deliver,
    print_fits,
    read_all,
)
from nrs_design.identification.facts.tool import tool_facts
from nrs_design.proof.text import counted

if TYPE_CHECKING:
    from nrs_design.identification.tool import ToolIdentification


@command("identify-tool")
def tool(
    data: DataFiles,
    columns: ColumnMap = None,
    gravity: Annotated[
        float | None, typer.Option(min=1e-3, help="In m/s^2; 9.81 if left out.")
    ] = None,
    write: WriteTo = None,
    report: ReportTo = None,
    date: Date = None,
) -> Answer:
    """Find mass and center of mass of a tool, and the bias of its force sensor, from poses.

    A row is a pose: the orientation of the sensor, qw, qx, qy, qz or roll_deg, pitch_deg, and the
    wrench fx_N, fy_N, fz_N, tx_Nm, ty_Nm, tz_Nm along its axes. Six poses or more that tilt about
    two axes; nothing but the tool touches the sensor. Intervals are at 95 %. --write puts tool and
    remaining bias into the sensor of the spec.

    Example: nrs-design identify tool specs/data/tool-poses.csv --report reports/tool.html
    """
    from nrs_design.identification.datasets import read_poses
    from nrs_design.identification.reporting.tool import tool_report
    from nrs_design.identification.tool import GRAVITY, identify_tool
    from nrs_design.identification.write_spec import check_interaction, merge_tool

    outputs = Destinations.checked(write, report, date)
    if outputs.spec is not None:
        check_interaction(outputs.spec)
    records = read_all(data, read_poses, columns or [])
    with progress("fitting"):
        found = identify_tool(records, gravity or GRAVITY)
    return deliver(outputs, found, tool_facts, _print, tool_report, merge_tool)


def _print(found: ToolIdentification) -> None:
    from nrs_design.identification.reporting.tool import estimates

    say(f"mass = {found.mass} kg [95 %], from {counted(len(found.force_errors), 'pose')}")
    print_fits(estimates(found))
