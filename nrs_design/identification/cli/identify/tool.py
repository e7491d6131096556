"""``nrs-design identify tool``: mass, center of mass and bias of what hangs on the sensor."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nrs_design.cli.command import Answer, command
from nrs_design.cli.destinations import Destinations
from nrs_design.cli.options import Date, ReportTo
from nrs_design.cli.printing import progress, say
from nrs_design.cli.tables import print_table
from nrs_design.identification.cli.identify.common import (
    SYNTHETIC,
    ColumnMap,
    DataFiles,
    WriteTo,
    estimate_numbers,
    read_all,
    sources,
)

if TYPE_CHECKING:
    from nrs_design.identification.tool import ToolIdentification
    from nrs_design.reporting import Report


@command("identify-tool")
def tool(
    data: DataFiles,
    columns: ColumnMap = None,
    gravity: Annotated[float, typer.Option(min=1e-3, help="In m/s^2.")] = 9.81,
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
    from nrs_design.identification.tool import identify_tool
    from nrs_design.identification.write_spec import check_tool, merge_tool

    outputs = Destinations.checked(write, report, date)
    if outputs.spec is not None:
        check_tool(outputs.spec)
    records = read_all(data, read_poses, columns or [])
    with progress("fitting"):
        found = identify_tool(records, gravity)
    return outputs.deliver(
        Answer(lambda: _summary(found), lambda: _print(found)),
        page=lambda: _page(found),
        merge=lambda spec: merge_tool(spec, found),
        caveats=found.doubts,
        slips=found.slips,
    )


def _page(found: ToolIdentification) -> Report:
    from nrs_design.identification.reporting.tool import tool_report

    return tool_report(found)


def _print(found: ToolIdentification) -> None:
    if found.synthetic:
        say(SYNTHETIC)
    say(f"mass = {found.mass} kg [95 %], from {len(found.force_errors)} poses")
    rows = [
        [axis, *map(str, estimates)]
        for axis, *estimates in zip(
            "xyz", found.center, found.force_bias, found.torque_bias, strict=True
        )
    ]
    print_table("", ["along", "center of mass m", "bias N", "bias N m"], rows)
    for doubt in found.doubts:
        say(f"doubt: {doubt}")


def _summary(found: ToolIdentification) -> dict[str, Any]:
    def along(estimates: Any) -> dict[str, Any]:
        return {axis: estimate_numbers(e) for axis, e in zip("xyz", estimates, strict=True)}

    return {
        "synthetic": found.synthetic,
        "records": sources(record.source for record in found.records),
        "poses": len(found.force_errors),
        "gravity_m_s2": found.gravity,
        "mass_kg": estimate_numbers(found.mass),
        "center_of_mass_m": along(found.center),
        "force_bias_N": along(found.force_bias),
        "torque_bias_Nm": along(found.torque_bias),
        "rmse": {"force_N": found.rmse[0], "torque_Nm": found.rmse[1]},
        "doubts": list(found.doubts),
        "slips": list(found.slips),
    }
